//! The conservative form: a body in its mean-axis frame, with momenta for its state.
//! Eqs. (C1)–(C7) of `docs/method/conservative.md`, and Eqs. (H1)–(H2) of `docs/method/constraints.md`:
//!
//! ```text
//! x = r + Aᵀ (X + Ψ_f q)
//! J(q)_ij = J0_ij + 2 c_ij·q + qᵀ N_ij q          S(q)_i = b_i + G_i q
//! ω = (J − SᵀS)⁻¹ (π − Sᵀp),      q̇ = p − S ω
//! π' = π × ω + Σ (X_k + u_k) × F_k(body)
//! p' = −Λq − D q̇ + Ψ_fᵀF + Σ_ij ω_i ω_j (c_ij + N_ij q) − Σ_i ω_i G_i q̇
//! P' = Σ F (global),   r' = P/m
//! energy = P²/2m + ½ π·ω + ½ p·q̇ + ½ q·Λq
//! ```
//!
//! For a body that turns freely and whose inertia follows its deformation, S and the G_i leave J and q̇ for the locked
//! inertia and p: q̇ = p − S ω need not be known for its forces, and one pass through the matrices gives all that a state
//! is asked for.
//!
//! ```text
//! 𝕁 = J − SᵀS = J0 + 2 c_ij·q + qᵀ N̂_ij q,      N̂_ij = N_ij + ½ (G_iG_j + G_jG_i)
//! Σ_ij ω_i ω_j (c_ij + N_ij q) − Σ_i ω_i G_i q̇ = Σ_ij ω_i ω_j (c_ij + N̂_ij q) − Σ_i ω_i G_i p
//! ```
//!
//! Hamiltonian without damping and loads: energy and `Aᵀπ` are constants of the motion for any number of modes.
//! The part of q' and p' that is linear in the modes, `q' = p, p' = −Λq − Dp`, is left to the integrators.
//!
//! i and j count the axes that the body turns about: three, the one of a hinge, or none. Where something drives the
//! body, ω is given, and the modes, which are those of the driven part held still, have a momentum b in its motion; b is
//! zero otherwise.
//!
//! With geometric stiffening the displacement is `Ψ_f q + u₂`, to second order in q, and each field of forces does its work
//! on u₂, too: of the centrifugal field, N_ij becomes `N_ij − Ψ_fᵀ K_ij Ψ_f`; the inertia of a driven motion of speed v adds
//! `v' K q` to p'; a load has its own in [`SecondOrder`](crate::SecondOrder).
//!
//! The momentum of a driven motion has −(K q)·q̇ besides, which changes the Lagrangian by `−v (½ qᵀK q)'`. That is
//! `½ v' qᵀK q` but for a total derivative: in p, −v K q would be as large as the momenta of stiff modes. Where v jumps, p
//! jumps by K q times as much.
//!
//! On the manifold of large deflection K acts on q: on ξ it would work on what the modes draw in, and that is of fourth
//! order, where the strain energy has terms of its own size against it. Of the spin alone, its parts between a large mode
//! and another act on ξ, which is of third order.
//!
//! With large deflection the equations are those of the extended shapes, with coordinates ξ(q) and their slopes D on a
//! curved manifold ([`Manifold`](crate::conservative::manifold::Manifold)). The constants are those of the coordinates z by which
//! ξ = E z, the modes and the products of the large ones; D is E ∂z/∂q:
//!
//! ```text
//! S = Dᵀ S_ext(ξ),  M = DᵀD:      p = M q̇ + S ω,   π = J(ξ) ω + Sᵀ q̇,   ν = D q̇,   μ = ν + S_ext ω
//! ω = (J − SᵀM⁻¹S)⁻¹ (π − SᵀM⁻¹p),      q̇ = M⁻¹ (p − S ω)
//! p' = Dᵀ [Σ ω_iω_j (c_ij + N_ij ξ) − Σ ω_i G_i ν + Ψ_extᵀF] + Ḋᵀμ − Λq − D q̇ − ∂V_n/∂q
//! ```
//!
//! About a bent reference X stands for the nodes of the bent body, Λ for its stiffness, and p' has −g − Bq
//! ([`ReferenceForces`](crate::ReferenceForces)).

pub(crate) mod body;
mod build;
mod coordinates;
mod energy;
mod equations;
mod errors;
pub(crate) mod frame;
mod load_scale;
pub(crate) mod manifold;
mod methods;
mod observation;
mod rates;
mod reference;
mod start;
mod state;

pub use body::ConservativeBody;
pub(crate) use coordinates::InCoordinates;
pub use rates::evaluation::Evaluation;
pub(crate) use state::{SLOW, Slow, get, part, set};
