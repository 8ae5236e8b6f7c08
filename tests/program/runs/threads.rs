//! The main types can be sent to other threads and shared between them: this file compiles.

use flexframe::{advice, dynamics, fem_tet10, modal, reduced_body, results, scene};

const fn is_send_and_sync<T: Send + Sync>() {}

const _: () = {
    is_send_and_sync::<fem_tet10::Mesh>();
    is_send_and_sync::<fem_tet10::Matrices>();
    is_send_and_sync::<modal::Modes>();
    is_send_and_sync::<reduced_body::ReducedBody>();
    is_send_and_sync::<dynamics::Simulation>();
    is_send_and_sync::<dynamics::Setup<'static>>();
    is_send_and_sync::<dynamics::SimulationBuilder<'static>>();
    is_send_and_sync::<dynamics::SharedLoad>();
    is_send_and_sync::<dynamics::Event>();
    is_send_and_sync::<dynamics::Observation>();
    is_send_and_sync::<dynamics::SetupError>();
    is_send_and_sync::<dynamics::StepError>();
    is_send_and_sync::<advice::AdviceError>();
    is_send_and_sync::<results::Results>();
    is_send_and_sync::<results::Writer<flexframe::row::Row>>();
    is_send_and_sync::<scene::Body>();
    is_send_and_sync::<model::Model>();
};
