//! Flexible-body dynamics: from a finite-element mesh to the motion of the body.
