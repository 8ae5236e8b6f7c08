"""Eigenpairs of K x = lambda M x, or static responses K u = f, by SLEPc, PETSc and MUMPS on any number of MPI ranks.

    mpirun -n RANKS python3 driver.py

flexframe wrote this file and those beside it, and reads what it leaves there:

    problem.json         sizes, the number of modes, the shift s, the tolerance, and the digest of K and M
    K.petsc M.petsc      the matrices of the body as its supports leave it (PETSc's binary form, as all .petsc files)
    rigid.petsc          its rigid motions, M-orthonormal, which K does not resist
    forces-NAME.petsc    forces to which static responses are asked for, with their number in forces-NAME.json; any number of these

    modes.petsc          the eigenvectors, and modes.json, which is there once they are complete
    statics-NAME.petsc   the displacements, and statics-NAME.json

Answers that are there already are not computed again.
Every rank must see the folder. Options for PETSc and MUMPS are taken from the environment variable PETSC_OPTIONS.
"""

import os
import sys

FOLDER = os.path.dirname(os.path.realpath(__file__))
# Modules come from where Python has them. A file of others in this folder, such as a json.py, is none of them.
sys.path = [place for place in sys.path if place and os.path.realpath(place) != FOLDER]

import glob
import json
import re
import time
import traceback
from pathlib import Path

FOLDER = Path(FOLDER)
# Eigenpairs beside those that are asked for: the count of eigenvalues is taken in the widest gap between them, which is no gap
# below this part of the eigenvalue.
SPARE = 4
GAP = 1e-6
# Iterations of a static response, and its residual in the norm of (K + sM)^-1, relative to that of the force.
ITERATIONS = 300
STATIC_TOLERANCE = 1e-13


class Refused(Exception):
    def __init__(self, found, help, is_missing=False):
        super().__init__(found)
        self.help = help
        self.is_missing = is_missing


def say(**line):
    """A line of JSON for the program that has started this."""
    print(json.dumps(line), flush=True)


def import_slepc():
    if sys.prefix == "/usr":
        # Without its development packages Debian keeps them outside of Python's path.
        for name in ("petsc", "slepc"):
            sys.path += sorted(glob.glob(f"/usr/lib/{name}dir/{name}*/*-real/lib/python3/dist-packages"), reverse=True)
    try:
        import slepc4py

        # No options from the command line, nor from a .petscrc.
        slepc4py.init([*sys.argv[:1], "-skip_petscrc"])
        from petsc4py import PETSc
        from slepc4py import SLEPc
    except Exception as error:
        raise Refused(
            f"{sys.executable} has no slepc4py that works ({error})",
            "install SLEPc: apt-get install python3-slepc4py python3-petsc4py openmpi-bin (Debian, Ubuntu), or conda install -c "
            "conda-forge slepc4py openmpi; name that Python in FLEXFRAME_MPI_PYTHON if it is not python3",
            is_missing=True,
        )
    found = f"PETSc with {PETSc.ScalarType.__name__} numbers and {PETSc.IntType.__name__} indices"
    if PETSc.ScalarType().dtype.str[1:] != "f8" or PETSc.IntType().dtype.str[1:] != "i4":
        raise Refused(found, "use a PETSc of real numbers in double precision and indices of 32 bits, as most packages are", True)
    if not PETSc.Sys.hasExternalPackage("mumps"):
        raise Refused("PETSc without MUMPS", "use a PETSc with MUMPS, as that of Debian and conda-forge", True)
    return PETSc, SLEPc


class Driver:
    def __init__(self):
        self.PETSc, self.SLEPc = import_slepc()
        self.rank = self.PETSc.COMM_WORLD.rank
        self.times = {}
        self.factor_entries = self.megabytes = 0
        self.problem = json.loads((FOLDER / "problem.json").read_text())
        # Before any rank answers anything.
        self.asks_modes = self.problem["modes"] > 0 and not (FOLDER / "modes.json").exists()
        names = sorted(path.stem.removeprefix("forces-") for path in FOLDER.glob("forces-*.json"))
        self.asked_statics = [name for name in names if not (FOLDER / f"statics-{name}.json").exists()]
        with self.timed("load"):
            self.K, self.M = self.matrix("K.petsc"), self.matrix("M.petsc")
            self.rigid = self.vectors("rigid.petsc", self.problem["rigid"])
        if self.K.size[0] != self.problem["unknowns"] or self.M.size != self.K.size:
            raise Refused(f"matrices of {self.K.size[0]} and {self.M.size[0]} rows", "write the folder again")

    def say(self, **line):
        if self.rank == 0:
            say(**line)

    def timed(self, phase):
        self.say(phase=phase)
        return Timed(self.times, phase)

    # Files

    def viewer(self, name, mode):
        return self.PETSc.Viewer().createBinary(str(FOLDER / name), mode)

    def matrix(self, name):
        matrix = self.PETSc.Mat().create()
        matrix.setType("aij")
        matrix.load(self.viewer(name, "r"))
        matrix.setOption(self.PETSc.Mat.Option.SYMMETRIC, True)
        return matrix

    def vectors(self, name, count):
        viewer = self.viewer(name, "r") if count else None
        vectors = [self.K.createVecRight() for _ in range(count)]
        for vector in vectors:
            vector.load(viewer)
        return vectors

    def leave(self, name, vectors, **answer):
        """Leaves vectors and what is known of them: the JSON file last, each file whole."""
        partial = f"{name}.petsc.part"
        viewer = self.viewer(partial, "w")
        for vector in vectors:
            vector.view(viewer)
        viewer.destroy()
        if self.rank:
            return
        (FOLDER / f"{partial}.info").unlink(missing_ok=True)
        os.replace(FOLDER / partial, FOLDER / f"{name}.petsc")
        answer.update(
            digest=self.problem["digest"],
            unknowns=self.problem["unknowns"],
            ranks=self.PETSc.COMM_WORLD.size,
            petsc=self.PETSc.Sys.getVersion(),
            slepc=self.SLEPc.Sys.getVersion(),
            factor_entries=self.factor_entries,
            megabytes=self.megabytes,
            times=self.times,
        )
        partial = FOLDER / f"{name}.json.part"
        partial.write_text(json.dumps(answer, indent=1) + "\n")
        os.replace(partial, FOLDER / f"{name}.json")

    # Factors

    def prepare(self, pc):
        """Has MUMPS factor a symmetric matrix as L D L^T."""
        pc.setOptionsPrefix("")
        pc.setType("cholesky")
        pc.setFactorSolverType("mumps")

    def factored(self, pc, *set_up):
        """The factor, once these functions have made it."""
        try:
            for step in set_up:
                step()
            factor = pc.getFactorMatrix()
            status = factor.getMumpsInfog(1)
        except self.PETSc.Error as error:
            said = re.search(r"INFOG\(1\)=(-\d+)", str(error))
            if not said:
                raise
            status = int(said[1])
        if status < 0:
            raise Refused(
                f"MUMPS cannot factor the matrix: INFOG(1) = {status}",
                "-8 and -9: give it more room, PETSC_OPTIONS='-mat_mumps_icntl_14 200'; -13 and -19: there is not enough "
                "memory, use more machines; -10: the body is a mechanism; others: see the manual of MUMPS",
            )
        # Millions where it is negative.
        entries = factor.getMumpsInfog(29)
        self.factor_entries = max(self.factor_entries, entries if entries >= 0 else -1_000_000 * entries)
        self.megabytes = max(self.megabytes, factor.getMumpsInfog(22))
        return factor

    def shifted(self, sigma):
        """K - sigma M."""
        matrix = self.K.copy()
        matrix.axpy(-sigma, self.M)
        matrix.setOption(self.PETSc.Mat.Option.SYMMETRIC, True)
        return matrix

    def count_below(self, sigma):
        """The number of eigenvalues below sigma, by Sylvester's law of inertia."""
        pc = self.PETSc.PC().create()
        pc.setOperators(self.shifted(sigma))
        self.prepare(pc)
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        # The root of the tree not by ScaLAPACK, which does not count; pivots that are zero are told apart.
        factor.setMumpsIcntl(13, 1)
        factor.setMumpsIcntl(24, 1)
        negative, zero, _ = self.factored(pc, pc.setUp).getInertia()
        pc.destroy()
        if zero:
            raise Refused(f"{zero} pivots of K - {sigma:.6e} M that are zero", "ask for a mode more or less")
        return negative

    # Modes

    def modes(self):
        """Searches on beside the eigenpairs found so far until a count of the eigenvalues says that none is missing. How many
        copies of a repeated eigenvalue one search finds is a matter of rounding, so the number of searches has no bound; a
        search that finds none of the missing ones ends them."""
        rigid, available = self.problem["rigid"], self.problem["available"]
        eps, found, searches, below, missing = self.solver(), [], 0, None, self.problem["modes"]
        while True:
            found += self.search(eps, min(missing + SPARE, available - len(found)), found)
            found.sort(key=lambda pair: pair[0])
            searches += 1
            if below is None:
                below = self.gap([value for value, _, _ in found])
                if below is None:
                    missing = len(found)
                    continue
                with self.timed("count"):
                    counted = self.count_below(below)
                missing = counted - rigid
            inside = sum(value < below for value, _, _ in found)
            before, missing = missing, counted - rigid - inside
            if missing <= 0:
                break
            if missing == before or len(found) == available:
                raise Refused(
                    f"{inside} eigenvalues found below {below:.6e} (rad/time)^2 in {searches} searches, none by the last, and "
                    f"{missing} more by a count of the pivots",
                    "is the stiffness not positive semi-definite? `flexframe modes` without --solver says more, on a coarser mesh",
                )
        eps.destroy()
        self.leave(
            "modes",
            [vector for _, vector, _ in found[:inside]],
            eigenvalues=[value for value, _, _ in found[:inside]],
            residuals=[residual for _, _, residual in found[:inside]],
            below=below,
            counted=counted,
            searches=searches,
        )

    def solver(self):
        """Shift-invert at -s, with the factor of K + sM: the largest mu = 1 / (lambda + s) are the smallest eigenvalues."""
        SLEPc = self.SLEPc
        eps = SLEPc.EPS().create()
        eps.setOperators(self.K, self.M)
        eps.setProblemType(SLEPc.EPS.ProblemType.GHEP)
        eps.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
        eps.setTolerances(self.problem["tolerance"], 1000)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
        eps.setTarget(-self.problem["shift"])
        st = eps.getST()
        st.setType(SLEPc.ST.Type.SINVERT)
        st.setShift(-self.problem["shift"])
        ksp = st.getKSP()
        ksp.setType("preonly")
        self.prepare(ksp.getPC())
        eps.setDimensions(self.problem["modes"])
        with self.timed("factor"):
            self.factored(ksp.getPC(), eps.setUp, ksp.setUp)
        return eps

    def search(self, eps, count, found):
        """Pairs with the smallest eigenvalues beside the rigid motions and those found: of each the eigenvalue, the vector, and
        |(K + sM)^-1 M x - mu x|_M / mu."""
        eps.setDimensions(count)
        eps.setDeflationSpace(self.rigid + [vector for _, vector, _ in found])
        of = self.problem["modes"]
        already = len(found)
        eps.cancelMonitor()
        eps.setMonitor(lambda _eps, _step, done, _values, _errors: self.say(converged=min(already + done, of), of=of))
        with self.timed("search"):
            eps.solve()
            if eps.getConverged() < count:
                raise Refused(
                    f"{eps.getConverged()} of {count} eigenpairs converged in {eps.getIterationNumber()} restarts",
                    "ask for fewer modes",
                )
            return [self.pair(eps, eps.getST(), i) for i in range(count)]

    def pair(self, eps, st, i):
        vector, answer = self.K.createVecs()
        value = eps.getEigenpair(i, vector).real
        mu = 1.0 / (value + self.problem["shift"])
        # SLEPc purifies vectors by the operator, which magnifies what rounding has left of the rigid motions.
        self.take_out_rigid(vector)
        st.apply(vector, answer)
        answer.axpy(-mu, vector)
        self.take_out_rigid(answer)
        return value, vector, self.norm(answer) / mu

    def take_out_rigid(self, vector):
        product = self.M * vector
        for rigid in self.rigid:
            vector.axpy(-rigid.dot(product), rigid)

    def norm(self, vector):
        return max(vector.dot(self.M * vector), 0.0) ** 0.5

    def gap(self, values):
        """Where the eigenvalues are to be counted: in the widest gap after the wanted ones; none where there is no gap yet."""
        wanted = self.problem["modes"]
        if len(values) == self.problem["available"]:
            return 2.0 * values[-1]
        if len(values) <= wanted:
            return None
        width, place = max((values[i] - values[i - 1], i) for i in range(wanted, len(values)))
        return values[place] - 0.5 * width if width > GAP * abs(values[place]) else None

    # Static responses

    def statics(self):
        """K u = f by conjugate gradients, the factor of K + sM before them. A force does no work on a rigid motion."""
        PETSc = self.PETSc
        # PETSc wants them orthonormal.
        rigid = []
        for motion in self.rigid:
            vector = motion.copy()
            for _ in range(2):
                for other in rigid:
                    vector.axpy(-other.dot(vector), other)
            vector.normalize()
            rigid.append(vector)
        self.K.setNullSpace(PETSc.NullSpace().create(vectors=rigid))
        ksp = PETSc.KSP().create()
        ksp.setOperators(self.K, self.shifted(-self.problem["shift"]))
        ksp.setType("cg")
        ksp.setNormType(PETSc.KSP.NormType.NATURAL)
        ksp.setTolerances(rtol=STATIC_TOLERANCE, atol=0.0, max_it=ITERATIONS)
        self.prepare(ksp.getPC())
        with self.timed("factor"):
            self.factored(ksp.getPC(), ksp.setUp)
        for name in self.asked_statics:
            self.respond(ksp, name)

    def respond(self, ksp, name):
        count = json.loads((FOLDER / f"forces-{name}.json").read_text())["count"]
        forces = self.vectors(f"forces-{name}.petsc", count)
        answers, iterations, residuals = [], [], []
        with self.timed("search"):
            for force in forces:
                answer = self.K.createVecRight()
                if force.norm() > 0.0:
                    ksp.solve(force, answer)
                rest = force - self.K * answer
                before, after = (self.natural(ksp, vector) for vector in (force, rest))
                answers.append(answer)
                iterations.append(ksp.getIterationNumber())
                residuals.append(after / before if before > 0.0 else 0.0)
                self.say(converged=len(answers), of=count)
        self.leave(f"statics-{name}", answers, iterations=iterations, residuals=residuals)

    def natural(self, ksp, force):
        """The norm of a force in (K + sM)^-1."""
        answer = self.K.createVecRight()
        ksp.getPC().apply(force, answer)
        return max(force.dot(answer), 0.0) ** 0.5


class Timed:
    def __init__(self, times, phase):
        self.times, self.phase = times, phase

    def __enter__(self):
        self.start = time.perf_counter()

    def __exit__(self, *_):
        self.times[self.phase] = self.times.get(self.phase, 0.0) + time.perf_counter() - self.start


def main():
    try:
        driver = Driver()
        if driver.asks_modes:
            driver.modes()
        if driver.asked_statics:
            driver.statics()
    except Refused as refused:
        say(error=str(refused), help=refused.help, is_missing=refused.is_missing)
    except BaseException:
        traceback.print_exc()
    else:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    # At once: an ordinary end would wait for the other ranks.
    os._exit(1)


main()
