# Recipes of flexframe; `./dev RECIPE` installs what is missing first.

set shell := ["bash", "-euo", "pipefail", "-c"]

flexframe := "target/release/flexframe"

# Show this list.
default:
    @just --list --unsorted

# The paper's plate, from mesh to table and figures, into out/plate.
plate: build
    {{flexframe}} paper examples/plate.toml -o out/plate --overwrite

# Every test.
test:
    cargo test --workspace --quiet

# Formatting, clippy and rustdoc, with warnings as errors.
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --quiet -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --document-private-items --quiet

# The program, optimised: target/release/flexframe.
build:
    cargo build --release --quiet --package flexframe

# Make the meshes again from their .geo files (gmsh).
mesh:
    cd meshes && for geo in *.geo; do gmsh -3 -format msh41 -v 2 "$geo" -o "${geo%.geo}.msh"; done

# The moving picture of the README.
picture: build
    {{flexframe}} animate examples/tumbling_plate.toml -o docs/tumbling_plate.gif --frames 80

# What accuracy costs: docs/accuracy.md and its diagrams from real runs of three scenes (some minutes).
accuracy: build
    {{flexframe}} accuracy examples/accuracy/{pulse,tumbling,spin}.toml -o docs/accuracy.md

# Steps a second of every scheme on one core, and what each effect costs per step and in set-up.
bench:
    cargo bench --quiet --package frames-rk4 --bench steps
    cargo bench --quiet --package flexframe --bench effects

# Time `flexframe modes` against SciPy's eigsh with CHOLMOD on three meshes (some minutes; Python packages).
bench-modes: build
    crates/modal/benches/peer/run

# Read a results file with h5py, as a user would (Python packages).
h5py: build
    {{flexframe}} run examples/ring.toml -o out/ring --overwrite
    python3 -m venv --upgrade-deps .tools/h5py >/dev/null
    .tools/h5py/bin/pip install -q h5py
    .tools/h5py/bin/python crates/results/tests/read_with_h5py.py out/ring/ring.h5
