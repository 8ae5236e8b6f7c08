# Recipes of flexframe; `./dev RECIPE` installs what is missing first.

set shell := ["bash", "-euo", "pipefail", "-c"]

flexframe := "target/release/flexframe"

# Show this list.
default:
    @just --list --unsorted

# The paper's plate, from mesh to table, figures and a page to look at, into out/plate.
plate: build
    {{flexframe}} paper examples/plate.toml -o out/plate --overwrite
    {{flexframe}} report out/plate/plate.h5 --overwrite

# Every test, two programs of them at a time.
test:
    .ci/tests

# The answers of all commands on the examples against those that are kept (tests/golden); `./dev golden --accept` keeps new ones.
golden *options:
    cargo build --quiet --package flexframe-cli
    tests/golden/golden.py target/debug/flexframe {{options}}

# A crate of somebody else, which sees only what is public: an own load, observer, scheme, force between bodies and joint.
outside:
    cargo test --manifest-path tests/outside/Cargo.toml --target-dir target --locked --quiet

# Formatting, clippy and rustdoc, with warnings as errors.
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --quiet -- -D warnings
    # With clippy's arguments rustdoc takes what clippy has checked. Where clippy names them otherwise, the compiler checks it again.
    RUSTC_WORKSPACE_WRAPPER="$(rustc --print sysroot)/bin/clippy-driver" \
        CLIPPY_ARGS="-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__" RUSTDOCFLAGS="-D warnings" \
        cargo doc --workspace --no-deps --document-private-items --quiet

# No file of a crate uses another that uses it in turn.
circles:
    .ci/circles

# Documentation of items begins with what they are, and limits have one word.
words:
    .ci/words

# Links, pages, paths and functions that the documentation names are there.
pages:
    .ci/pages
    .ci/python-page --check

# How many numbers in tests are closed forms, independent references, conserved, or regression only; --check for silent files.
references *args:
    .ci/references {{args}}

# The documentation as a book with a search, target/book/index.html: after the links and names of its pages, its commands and scenes have been tried.
book: pages
    test -x .tools/bin/mdbook || cargo install --quiet --locked --no-default-features --features search --root .tools mdbook@0.5.4
    cargo test --quiet --package flexframe-cli --test program documentation
    .tools/bin/mdbook build docs
    .ci/book target/book

# Everything once with the oldest Rust that is promised (`rust-version` in Cargo.toml).
msrv:
    #!/usr/bin/env bash
    set -euo pipefail
    stated=$(sed -n 's/^rust-version = "\([0-9.]*\)".*/\1/p' Cargo.toml)
    is_stated() { [[ "$1" == "$stated" || "$1" == "$stated".* ]]; }
    here=$(rustc --version | cut -d ' ' -f 2)
    if ! is_stated "$here"; then
        installed=$(rustup toolchain list 2>/dev/null | cut -d - -f 1 || true)
        RUSTUP_TOOLCHAIN=$(for version in $installed; do if is_stated "$version"; then echo "$version"; fi; done | tail -1)
        if [ -z "$RUSTUP_TOOLCHAIN" ]; then
            echo "msrv: Cargo.toml promises Rust $stated, but the compiler here is $here and rustup has no $stated:" \
                "install it (rustup toolchain install $stated), or promise in rust-version what is built with" >&2
            exit 1
        fi
        export RUSTUP_TOOLCHAIN
    fi
    cargo check --workspace --all-targets --quiet
    echo "msrv: builds with $(rustc --version)"

# The program, optimised: target/release/flexframe. Beside it the library that goes into FMUs.
build:
    cargo build --release --quiet --package flexframe-cli --package fmi

# Make the meshes again from their .geo files (gmsh).
mesh:
    cd meshes && for geo in *.geo; do gmsh -3 -format msh41 -v 2 "$geo" -o "${geo%.geo}.msh"; done

# The moving pictures of the README and of docs/systems.md; the plate's motion has to be within the range of the model.
picture: build
    mkdir -p out/picture
    {{flexframe}} run examples/mechanisms/deployment.toml -o out/picture --overwrite > out/picture/deployment.txt
    {{flexframe}} animate out/picture/deployment.h5 -o docs/start/deployment.gif --to 4 --frames 60 --overwrite
    for scene in hinge double_pendulum four_bar; do \
        {{flexframe}} run examples/mechanisms/$scene.toml -o out/picture --no-check --overwrite > out/picture/$scene.txt; \
        {{flexframe}} animate out/picture/$scene.h5 -o docs/systems/$scene.gif --view xz --frames 36 --overwrite; \
    done
    if {{flexframe}} run examples/thrown_plate.toml -o out/picture --overwrite | grep '^  warning'; then exit 1; fi
    {{flexframe}} animate examples/thrown_plate.toml -o docs/start/thrown_plate.gif --frames 80 --overwrite

# The pages of the first hour and of how-to, command by command; makes their pictures again.
first-hour:
    FLEXFRAME_ACCEPT=1 cargo test --quiet --package flexframe-cli --test program documentation

# Pages of the reference that are made of the sources: commands and their options, keys of scenes, columns of results, Python.
reference:
    FLEXFRAME_ACCEPT=1 cargo test --quiet --package flexframe-cli --bin flexframe documentation
    .ci/python-page

# Published benchmarks beside ours: docs/evidence/benchmarks.md (a minute or two).
benchmarks: build
    {{flexframe}} verify -o out/benchmarks --overwrite
    cp out/benchmarks/benchmarks.md docs/evidence/benchmarks.md

# The price of accuracy: docs/evidence/accuracy.md and its diagrams from real runs of three scenes (some minutes).
accuracy:
    cargo run --release --quiet --package verification --bin accuracy -- docs/evidence/accuracy.md examples/accuracy/{pulse,tumbling,spin}.toml --overwrite

# Hard cases with every scheme: docs/evidence/stability.md; then kills of many runs (some minutes). Fails where a
# bound is broken, a row is lost, or a damaged file is taken for a sound one.
stability:
    cargo run --release --quiet --package verification --bin stability -- docs/evidence/stability.md --overwrite
    FLEXFRAME_KILLS=200 cargo test --release --quiet --package results --test killed
    FLEXFRAME_FORGERIES=20000 cargo test --release --quiet --package results --test forged --test damage
    FLEXFRAME_KILLS=40 cargo test --release --quiet --package flexframe-cli --test faults

# docs/evidence/mesh-error.md: estimated errors of frequencies against those of fine meshes (gmsh; a few minutes).
mesh-error: build
    python3 crates/verification/mesh_error/measure.py {{flexframe}} docs/evidence/mesh-error.md

# Large deflection and stress against a nonlinear finite-element body, and the curves of docs/evidence/nonlinear.md (some minutes).
nonlinear:
    cargo test --release --quiet --package verification --test nonlinear --test systems -- --include-ignored --nocapture
    mkdir -p docs/evidence/nonlinear
    cargo run --release --quiet --package verification --bin nonlinear -- docs/evidence/nonlinear --overwrite

# The estimate of `flexframe check` over the truth, on bodies, loads, spins and models: docs/evidence/check.md (a minute).
check-table:
    cargo run --quiet --package verification --bin check -- docs/evidence/check.md --overwrite

# How often intervals of `flexframe fit` have the true values in them, in 200 trials with 1 % of noise: docs/evidence/fit.md (a minute or two).
fit-trials:
    cargo run --quiet --package verification --bin fit_trials -- docs/evidence/fit.md --overwrite

# Frequencies of a spinning disc in CalculiX, which a test of `flexframe campbell` has (calculix-ccx, Python packages; seconds).
calculix-disc:
    .tools/meshio/bin/python crates/verification/calculix/dished_disc.py out/calculix-disc

# The decks of tests/decks with their masses and frequencies by CalculiX and SciPy, and the table of docs/evidence/decks.md (calculix-ccx, Python packages; seconds).
decks:
    python3 -m venv .tools/decks
    .tools/decks/bin/pip install -q meshio==5.3.5 h5py==3.16.0 numpy==2.4.6 scipy==1.17.1
    .tools/decks/bin/python crates/verification/decks/make.py tests/decks docs/evidence/decks.md

# Decks written at random in the syntax of Nastran and Abaqus, 1000 each, all of one body: the counts in docs/evidence/decks.md (a minute).
random-decks:
    FLEXFRAME_DECKS=1000 cargo test --quiet --package mesh-import --test nastran_decks --test decks random -- --nocapture

# Steps a second of every scheme on one core, steps of chains of bodies, and what each effect costs per step and in set-up.
bench:
    cargo bench --quiet --package dynamics --bench steps
    cargo bench --quiet --package dynamics --bench chain
    cargo bench --quiet --package linear --bench response
    cargo bench --quiet --package flexframe-cli --bench effects

# The factor of K + sM and its solutions against faer's, in turn: the table of docs/evidence/factor.md (gmsh; ten minutes, on a quiet machine).
factor:
    #!/usr/bin/env bash
    set -euo pipefail
    mkdir -p out/factor
    mesh() {
        sed "s/\(MeshSizeM[a-z]*\) = .*;/\1 = $2;/" "$1" >out/factor/$3.geo
        gmsh -3 -format msh41 -v 2 out/factor/$3.geo -o out/factor/$3.msh
    }
    mesh meshes/plate.geo 6 plate_6
    mesh meshes/plate.geo 4.2 plate_4.2
    mesh crates/verification/performance/block.geo 5 block_5
    FLEXFRAME_MESHES=$(realpath out/factor/{plate_6,plate_4.2,block_5}.msh | paste -sd :) \
        cargo test --quiet --release --package modal --features threads-in-faer --lib against_faer -- --ignored --nocapture

# Layouts of small matrices in the time loop against each other and against faer: the second table of docs/evidence/factor.md (seconds, once built).
layouts:
    cargo test --quiet --release --package dynamics --lib the_layouts_of_matrices -- --ignored --nocapture

# docs/evidence/performance.md: against SciPy, SLEPc, CalculiX and Exudyn (`quick`: twenty minutes, `full`: hours, with all peers to their ends; parts: `modes`, `size`, `loop`, `page`).
performance *what: build
    .tools/performance/bin/python crates/verification/performance/performance.py {{what}}

# docs/evidence/systems.md: time against error of four systems, in flexframe and in Exudyn, in turn on one core (Python packages; some minutes).
exudyn: build
    cargo build --quiet --package verification --bin systems
    python3 -m venv --upgrade-deps .tools/exudyn >/dev/null
    .tools/exudyn/bin/pip install -q exudyn==1.13.6 meshio==5.3.5 h5py==3.16.0 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
    RAYON_NUM_THREADS=1 .tools/exudyn/bin/python crates/verification/performance/systems.py \
        {{flexframe}} target/debug/systems docs/evidence/systems.md

# Random systems of rigid bodies against a reference in maximal coordinates: the counts in docs/evidence/systems.md (Python packages;
# an hour, goes on where it was interrupted).
random-systems *options: random-systems-python
    .tools/random-systems/bin/python crates/verification/random_systems/closed_forms.py
    nice .tools/random-systems/bin/python crates/verification/random_systems/measure.py target/debug/flexframe out/random-systems \
        --page docs/evidence/systems.md {{options}}

# Small systems that failed once, with their right values; before: a program to compare with
# (Python packages; a few minutes).
systems-cases *before: random-systems-python
    .tools/random-systems/bin/python crates/verification/systems_cases/measure.py target/debug/flexframe {{before}}

[private]
random-systems-python:
    cargo build --quiet --package flexframe-cli
    python3 -m venv .tools/random-systems
    .tools/random-systems/bin/pip install -q h5py==3.16.0 numpy==2.4.6 scipy==1.17.1

# Random scenes, signals, forged files, decks, FMI calls and full disks against the program: the counts in docs/evidence/attacks.md
# (Python packages, gmsh; half an hour; `--only systems,fmi --part 0.1` for a part; full disks need the right to mount).
attacks *options: random-systems-python
    cargo build --quiet --package fmi
    nice .tools/random-systems/bin/python crates/verification/attacks/attacks.py target/debug/flexframe target/debug/libflexframe_fmi.so \
        out/attacks --page docs/evidence/attacks.md {{options}}

# Systems of bodies in joints by radau and rkmk4: processor time at equal error.
schemes:
    cargo build --quiet --package verification --bin systems
    RAYON_NUM_THREADS=1 python3 crates/verification/performance/schemes.py target/debug/systems

# The wheel of the Python package, with HDF5 inside, into target/wheels (Python packages).
wheel profile="release":
    #!/usr/bin/env bash
    set -euo pipefail
    # HDF5 wants a newer cmake than Debian has.
    python3 -m venv .tools/python
    .tools/python/bin/pip install -q "maturin>=1.9,<2" "cmake>=3.26"
    export PATH="$PWD/.tools/python/bin:$PATH"
    rm -f target/wheels/flexframe-*.whl
    maturin build --quiet --locked --profile {{profile}} --manifest-path crates/python/Cargo.toml --out target/wheels

# A controller of python-control and a spacecraft of MuJoCo with flexframe in the loop: examples/python (Python packages).
cosimulation profile="release": (wheel profile)
    python3 -m venv .tools/cosimulation
    .tools/cosimulation/bin/pip install -q control==0.10.2 mujoco==4.0.0
    .tools/cosimulation/bin/pip install -q --force-reinstall --no-deps target/wheels/flexframe-*.whl
    for example in lqr_panel mujoco_spacecraft; do .tools/cosimulation/bin/python examples/python/$example.py; done

# The Python package: its wheel, and its tests in a fresh installation (Python packages).
python profile="release": (wheel profile)
    #!/usr/bin/env bash
    set -euo pipefail
    target="${CARGO_TARGET_DIR:-$PWD/target}"
    built="$target/{{ if profile == "dev" { "debug" } else { profile } }}"
    export PATH="$PWD/.tools/python/bin:$PATH"
    # With the features of the wheel, so that nothing is built twice.
    cargo build --quiet --locked --profile {{profile}} --package flexframe-cli --package flexframe-python \
        --features flexframe-python/static-hdf5 --bin flexframe --example controller --example spring_to_ground
    rm -rf .tools/wheel
    python3 -m venv .tools/wheel
    .tools/wheel/bin/pip install -q target/wheels/flexframe-*.whl
    library=$(cd / && "$OLDPWD/.tools/wheel/bin/python" -c "import flexframe._flexframe as library; print(library.__file__)")
    if readelf --dynamic "$library" | grep NEEDED | grep -vE '\[(libc|libm|libgcc_s|libpthread|libdl|librt|ld-linux-[a-z0-9-]+)\.so'; then
        echo "python: the wheel needs a library that a machine may not have" >&2
        exit 1
    fi
    if [ {{profile}} = release ] && readelf --sections --wide "$library" | grep -q '\.debug_info'; then
        echo "python: the library in the wheel has debugging information" >&2
        exit 1
    fi
    .tools/wheel/bin/pip install -q pytest matplotlib pandas pandas-stubs xarray h5py mypy control
    FLEXFRAME="$built/flexframe" FLEXFRAME_EXAMPLES="$built/examples" FLEXFRAME_FIGURES="$PWD/out/python" \
        .tools/wheel/bin/python -m pytest -q -p no:cacheprovider crates/python
    ls target/wheels/flexframe-*.whl

# Read a results file and a body file with h5py, as a user would (Python packages).
h5py: build
    {{flexframe}} run examples/ring.toml -o out/ring --overwrite
    python3 -m venv --upgrade-deps .tools/h5py >/dev/null
    .tools/h5py/bin/pip install -q h5py
    .tools/h5py/bin/python crates/results/tests/read_with_h5py.py out/ring/ring.h5
    {{flexframe}} reduce examples/ring.toml -o out/ring/ring.body.h5 --matrices --overwrite
    {{flexframe}} run tests/bent_rod.toml -o out/bent --overwrite
    {{flexframe}} reduce tests/bent_rod.toml -o out/bent/bent_rod.body.h5 --stress --overwrite
    {{flexframe}} export out/bent/bent_rod.h5 --vtkhdf out/bent/bent_rod.vtkhdf --volume --overwrite
    .tools/h5py/bin/python tests/read_body_with_h5py.py out/ring/ring.body.h5 out/ring/ring.h5 \
        out/bent/bent_rod.body.h5 out/bent/bent_rod.h5 out/bent/bent_rod.vtkhdf

# FMUs in FMPy: its validator, runs against the program's own, a controller outside (Python packages).
fmu-test: build
    python3 -m venv --upgrade-deps .tools/fmpy >/dev/null
    .tools/fmpy/bin/pip install -q fmpy==0.3.32 h5py
    .tools/fmpy/bin/python crates/fmi/tests/run_with_fmpy.py {{flexframe}}

# Read exports with VTK's own readers, and compare them with the modes of linear strain (Python packages, 150 MB).
paraview: build
    {{flexframe}} run examples/ring.toml --set effects.large_deflection=false -o out/paraview --overwrite
    {{flexframe}} reduce examples/ring.toml --set effects.large_deflection=false --stress -o out/paraview/ring.body.h5 --overwrite
    {{flexframe}} run tests/two.toml -o out/paraview --overwrite
    for body in ring bar; do \
        {{flexframe}} reduce tests/two.toml --body $body --stress -o out/paraview/two.$body.body.h5 --overwrite; done
    python3 -m venv --upgrade-deps .tools/paraview >/dev/null
    .tools/paraview/bin/pip install -q h5py vtk
    for cells in "" --volume; do \
        {{flexframe}} export out/paraview/ring.h5 --vtkhdf out/paraview/ring.vtkhdf --modes out/paraview/modes.vtkhdf \
            --vtu out/paraview/vtu --every 200 --overwrite $cells && \
        .tools/paraview/bin/python tests/read_with_vtk.py \
            out/paraview/{ring.h5,ring.vtkhdf,modes.vtkhdf,vtu} && \
        {{flexframe}} export out/paraview/two.h5 --vtkhdf out/paraview/two.vtkhdf --modes out/paraview/two_modes.vtkhdf \
            --vtu out/paraview/vtu --overwrite $cells && \
        .tools/paraview/bin/python tests/read_with_vtk.py \
            out/paraview/{two.h5,two.vtkhdf,two_modes.vtkhdf,vtu} || exit 1; \
    done

# Build the pages of reports and responses from their sources (npm). They are checked in, so that nobody else needs npm.
report-page:
    cd crates/report/web && npm ci --silent --no-audit --no-fund && npm run --silent build

# Build the program of live pages, the crate `live` as WebAssembly (Debian's Rust for the web). It is checked in beside the page.
live-page:
    #!/usr/bin/env bash
    set -euo pipefail
    export RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 # -Zbuild-std needs no target that would have to be fetched
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER=wasm-ld-19
    # No paths of this machine, so that it comes out the same on every one.
    registry="${CARGO_HOME:-$HOME/.cargo}/registry/src/"
    export CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS="-Ctarget-feature=+simd128 -Zlocation-detail=none \
    --remap-path-prefix=$PWD= --remap-path-prefix=$registry=registry/"
    /usr/bin/cargo build --quiet --locked --package live --profile page --target wasm32-unknown-unknown \
        -Zbuild-std=std,panic_abort --target-dir target/page
    gzip -9nc target/page/wasm32-unknown-unknown/page/live.wasm >crates/report/web/live.wasm.gz
    .ci/live-sources >crates/report/web/live.sources

# Live pages in Node against results files, with the work of a frame, and in a headless Chromium; before that, whether their program is what its sources give (npm).
live-page-test:
    #!/usr/bin/env bash
    set -euo pipefail
    .ci/live-sources | cmp - crates/report/web/live.sources || {
        echo "live-page-test: live.wasm.gz is not what its sources give: run ./dev live-page" >&2
        exit 1
    }
    mkdir -p out/live-page
    cargo build --quiet --package flexframe-cli
    program=$(realpath "${CARGO_TARGET_DIR:-target}/debug/flexframe")
    for scene in examples/thrown_plate examples/mechanisms/double_pendulum tests/bent_rod tests/chain; do
        name=$(basename $scene)
        $program run $scene.toml -o out/live-page --no-check --overwrite >/dev/null
        $program export out/live-page/$name.h5 --csv out/live-page/$name.csv --overwrite >/dev/null
        $program report out/live-page/$name.h5 --live --overwrite >/dev/null
    done
    cd crates/report/web && npm ci --silent --no-audit --no-fund
    REPORTS=../../../out/live-page npm run --silent test-live
# Films of `flexframe animate` (ffmpeg).
film-test:
    cargo test --quiet --package flexframe-cli --test program films_have -- --ignored

# The pages of reports and responses in a headless Chromium; before that, whether they are what their sources give (npm).
report-page-test:
    mkdir -p out/report-page
    cd crates/report/web && npm ci --silent --no-audit --no-fund && npm run --silent build -- ../../../out/report-page
    for page in page responses; do cmp crates/report/web/$page.html out/report-page/$page.html || \
        { echo "report-page-test: $page.html is not what web/src gives: run ./dev report-page" >&2; exit 1; }; done
    for kind in small large unfinished rigid hinged nodes patch several compared responses; do \
        cargo run --quiet --package report --example synthetic -- $kind out/report-page/$kind.html; done
    cd crates/report/web && REPORTS=../../../out/report-page npm test --silent

# Fuzz every reader for so many seconds each (libFuzzer; wants a nightly compiler, and an hour for its build on two busy cores).
fuzz seconds="600":
    test -x .tools/bin/cargo-fuzz || cargo install --quiet --locked --root .tools cargo-fuzz@0.13.2
    mkdir -p crates/fuzz/corpus/{mesh,deck,scene,table,expression,results,fmi}
    cd crates/fuzz && export RUSTUP_TOOLCHAIN=nightly && \
    ../../.tools/bin/cargo-fuzz build --fuzz-dir . results-seeds && \
    "${CARGO_TARGET_DIR:-target}/$(rustc -vV | sed -n 's/^host: //p')/release/results-seeds" corpus/results && \
    features="" options="" && \
    fuzz() { ../../.tools/bin/cargo-fuzz run --fuzz-dir . --features "$features" "$1" "corpus/$1" "${@:2}" -- -max_total_time={{seconds}} \
        -max_len=65536 -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1 $options; } && \
    fuzz mesh ../fem-tet10/tests/data && \
    fuzz deck seeds/deck && \
    fuzz scene ../../examples ../../examples/mechanisms ../../tests ../scene/src && \
    fuzz table seeds/table && \
    fuzz expression seeds/expression && \
    fuzz results && \
    features=fmi options=-len_control=0 && fuzz fmi

# Licences, bans and sources of all dependencies (deny.toml).
deny:
    test -x .tools/bin/cargo-deny || cargo install --quiet --locked --root .tools cargo-deny@0.20.2
    .tools/bin/cargo-deny check licenses bans sources

# Known holes in dependencies; fetches a database.
advisories:
    test -x .tools/bin/cargo-deny || cargo install --quiet --locked --root .tools cargo-deny@0.20.2
    .tools/bin/cargo-deny check advisories
