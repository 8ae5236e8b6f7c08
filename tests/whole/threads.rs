//! The main types can be sent to other threads and shared between them: this file compiles.

use flexframe::{advice, fem_tet10, frames_rk4, modal, results, scene};

const fn is_send_and_sync<T: Send + Sync>() {}

const _: () = {
    is_send_and_sync::<fem_tet10::Mesh>();
    is_send_and_sync::<fem_tet10::Matrices>();
    is_send_and_sync::<modal::Modes>();
    is_send_and_sync::<modal::ReducedBody>();
    is_send_and_sync::<frames_rk4::Simulation>();
    is_send_and_sync::<frames_rk4::Setup<'static>>();
    is_send_and_sync::<frames_rk4::SimulationBuilder<'static>>();
    is_send_and_sync::<frames_rk4::SharedLoad>();
    is_send_and_sync::<frames_rk4::Event>();
    is_send_and_sync::<frames_rk4::Observation>();
    is_send_and_sync::<frames_rk4::SetupError>();
    is_send_and_sync::<frames_rk4::StepError>();
    is_send_and_sync::<advice::AdviceError>();
    is_send_and_sync::<results::Results>();
    is_send_and_sync::<results::Writer<frames_rk4::Observation>>();
    is_send_and_sync::<scene::Scene>();
    is_send_and_sync::<scene::Model>();
};
