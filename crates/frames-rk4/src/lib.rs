//! Motion of a flexible body in a sequence of reconfigured inertial frames.
