"""Random calls of the functions of FMI 2.0 to the library of an FMU, in processes of their own."""

import ctypes
import math
import os
import random
import shutil
import subprocess
import sys
import zipfile

import signals
import systems
from program import Count

CALLS = 120
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)


class Functions(ctypes.Structure):
    LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)
    _fields_ = [("logger", LOGGER)] + [(name, ctypes.c_void_p) for name in ["allocate", "free", "finished", "environment"]]


def worker(library, folder, guid, variables, seed):
    """One sequence; a line for each fault, and the number of calls and of errors."""
    rng = random.Random(seed)
    library = ctypes.CDLL(library)
    said = []
    functions = Functions(logger=Functions.LOGGER(lambda _, name, status, kind, words: said.append((status, words.decode(errors="replace")))))
    library.fmi2Instantiate.restype = ctypes.c_void_p
    resources = f"file://{folder}/resources".encode()
    wrong_guid = rng.random() < 0.05
    instance = library.fmi2Instantiate(b"x", 1, b"{no}" if wrong_guid else guid.encode(), rng.choice([resources] * 19 + [b"file:///nowhere"]), ctypes.byref(functions), 0, 0)
    if not instance:
        assert said and said[-1][0] == ERROR, said
        print("calls 1 1")
        return
    assert not wrong_guid
    c = ctypes.c_void_p(instance)
    states, errors, time, before = [], 0, 0.0, None
    number = lambda: rng.choice([0.0, 1.0, -1.0, 1e-3, rng.uniform(-10, 10), math.nan, math.inf, 1e300, 5e-324])
    references = lambda: [rng.randrange(variables) if rng.random() < 0.9 else rng.choice([variables, 2**32 - 1, 2**31]) for _ in range(rng.choice([0, 1, 2, 5]))]

    def all_values():
        names, values = (ctypes.c_uint * variables)(*range(variables)), (ctypes.c_double * variables)()
        return list(values) if library.fmi2GetReal(c, names, ctypes.c_size_t(variables), values) == OK else None

    def arrays(kind):
        names = references()
        return (ctypes.c_uint * len(names))(*names), ctypes.c_size_t(len(names)), (kind * len(names))()

    begin = rng.random() < 0.8
    if begin:
        library.fmi2SetupExperiment(c, 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0))
        library.fmi2EnterInitializationMode(c)
        library.fmi2ExitInitializationMode(c)
    for call in range(CALLS):
        which = rng.choice(["get", "get", "set", "set", "step", "step", "step", "step", "save", "restore", "free", "serialize", "garbage", "enter", "exit", "set up", "terminate", "reset",
                            "integer", "string", "derivative", "status", "null"] if call % 7 else ["step", "get"])
        heard = len(said)
        if which in ("terminate", "reset") and rng.random() < 0.7:
            which = "step"
        if which == "get":
            names, size, values = arrays(ctypes.c_double)
            status = library.fmi2GetReal(c, names, size, values)
            if status == OK and not all(math.isfinite(value) for value in values):
                print(f"fault: fmi2GetReal gives {list(values)}")
        elif which == "set":
            names, size, values = arrays(ctypes.c_double)
            for i in range(len(values)):
                values[i] = number()
            status = library.fmi2SetReal(c, names, size, values)
        elif which == "step":
            point, step = (time, 0.01) if rng.random() < 0.85 else (number(), number())
            status = library.fmi2DoStep(c, ctypes.c_double(point), ctypes.c_double(step), 1)
            if status == OK:
                time = point + step
        elif which == "save":
            state = ctypes.c_void_p()
            status = library.fmi2GetFMUstate(c, ctypes.byref(state))
            if status == OK:
                states.append((state, time, all_values()))
        elif which == "restore":
            if not states:
                continue
            state, time_then, values = rng.choice(states)
            status = library.fmi2SetFMUstate(c, state)
            if status == OK:
                time = time_then
                now = all_values()
                if values is not None and now is not None and now != values:
                    print("fault: a restored state has other values")
        elif which == "free":
            if not states:
                continue
            state = states.pop(rng.randrange(len(states)))[0]
            status = library.fmi2FreeFMUstate(c, ctypes.byref(state))
        elif which == "serialize":
            if not states:
                continue
            size = ctypes.c_size_t()
            state, time_then, values = rng.choice(states)
            status = library.fmi2SerializedFMUstateSize(c, state, ctypes.byref(size))
            if status == OK:
                data = ctypes.create_string_buffer(size.value)
                status = library.fmi2SerializeFMUstate(c, state, data, size)
                if rng.random() < 0.6:
                    for _ in range(rng.choice([0, 1, 8])):
                        data[rng.randrange(size.value)] = rng.randrange(256)
                    again = ctypes.c_void_p()
                    status = library.fmi2DeSerializeFMUstate(c, data, ctypes.c_size_t(size.value - rng.choice([0, 0, 1])), ctypes.byref(again))
                    if status == OK:
                        states.append((again, time_then, None))
        elif which == "garbage":
            data = ctypes.create_string_buffer(rng.randbytes(rng.choice([0, 1, 100, 5000])))
            state = ctypes.c_void_p()
            status = library.fmi2DeSerializeFMUstate(c, data, ctypes.c_size_t(len(data) - 1), ctypes.byref(state))
            if status == OK:
                print("fault: garbage taken for a state")
        elif which == "enter":
            status = library.fmi2EnterInitializationMode(c)
        elif which == "exit":
            status = library.fmi2ExitInitializationMode(c)
        elif which == "set up":
            status = library.fmi2SetupExperiment(c, rng.randint(0, 1), ctypes.c_double(number()), ctypes.c_double(number()), rng.randint(0, 1), ctypes.c_double(number()))
        elif which == "terminate":
            status = library.fmi2Terminate(c)
        elif which == "reset":
            status = library.fmi2Reset(c)
            time = 0.0 if status == OK else time
        elif which == "integer":
            names, size, values = arrays(ctypes.c_int)
            status = rng.choice([library.fmi2GetInteger, library.fmi2SetInteger, library.fmi2GetBoolean, library.fmi2SetBoolean])(c, names, size, values)
        elif which == "string":
            names, size, values = arrays(ctypes.c_char_p)
            status = rng.choice([library.fmi2GetString, library.fmi2SetString])(c, names, size, values)
        elif which == "derivative":
            names, size, values = arrays(ctypes.c_double)
            orders = (ctypes.c_int * len(values))(*[rng.choice([0, 1, 2, -1]) for _ in values])
            status = rng.choice([library.fmi2SetRealInputDerivatives, library.fmi2GetRealOutputDerivatives])(c, names, size, orders, values)
        elif which == "status":
            value = ctypes.c_double()
            status = library.fmi2GetRealStatus(c, rng.choice([0, 1, 2, 3, 9]), ctypes.byref(value))
        else:
            status = rng.choice([lambda: library.fmi2GetReal(c, None, ctypes.c_size_t(2), None), lambda: library.fmi2SetFMUstate(c, None),
                                 lambda: library.fmi2DeSerializeFMUstate(c, None, ctypes.c_size_t(4), None), lambda: library.fmi2GetFMUstate(c, None)])()
        if status in (ERROR, DISCARD):
            errors += 1
            # By the standard a status that is not there is discarded.
            if len(said) == heard and (which, status) != ("status", DISCARD):
                print(f"fault: {which} gives {status} without words")
        elif status not in (OK, WARNING):
            print(f"fault: {which} gives the status {status}")
        if any("bug of flexframe" in words for _, words in said[heard:]):
            print(f"fault: {which}: {said[-1][1][:200]}")
    for state, *_ in states:
        library.fmi2FreeFMUstate(c, ctypes.byref(state))
    library.fmi2FreeInstance(c)
    print(f"calls {CALLS} {errors}")


def attack(program, trials, first=0):
    count = Count("fmi", f"sequences of {CALLS} calls of the functions of FMI 2.0 in any order, with references that are none, NaN, null pointers, states restored, "
                  "serialised and damaged, to FMUs of a lone body and of two in joints, each in a process")
    folder = os.path.join(program.folder, "fmi")
    shutil.rmtree(folder, ignore_errors=True)
    fmus = []
    for name, scene in [("two", signals.PENDULUM), ("top", signals.TOP)]:
        here = os.path.join(folder, name)
        os.makedirs(here)
        with open(os.path.join(here, f"{name}.toml"), "w") as file:
            file.write(systems.text({key: value for key, value in scene.items() if key not in ("rows", "seconds")}))
        code, _, words = program.run(["fmu", f"{name}.toml", "-o", "x.fmu", "--library", program.library, "--overwrite"], here)
        assert code == 0, words
        zipfile.ZipFile(os.path.join(here, "x.fmu")).extractall(here)
        description = open(os.path.join(here, "modelDescription.xml"), encoding="utf-8").read()
        fmus.append((here, description.split('guid="')[1].split('"')[0], description.count("<ScalarVariable")))
    calls = errors = 0
    for seed in count.seeds(first, trials):
        here, guid, variables = fmus[seed % len(fmus)]
        arguments = [sys.executable, __file__, program.library, here, guid, str(variables), str(seed)]
        try:
            done = subprocess.run(arguments, capture_output=True, text=True, timeout=120, env=program.environment())
            lines = done.stdout.splitlines()
            faults = [line for line in lines if line.startswith("fault")]
            wrong = f"ended with {done.returncode}: {done.stderr[-300:]}" if done.returncode else "; ".join(faults[:3]) or None
            if lines and lines[-1].startswith("calls"):
                calls, errors = calls + int(lines[-1].split()[1]), errors + int(lines[-1].split()[2])
        except subprocess.TimeoutExpired:
            wrong = "too long"
        count.add("sequences", wrong, seed)
    count.note = f"{calls} calls, {errors} refused in words"
    return count


if __name__ == "__main__":
    worker(*sys.argv[1:4], int(sys.argv[4]), int(sys.argv[5]))
