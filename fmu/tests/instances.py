"""FMUs as the command line writes them, and their instances in FMPy, with the differences between the versions of FMI put away.

The program and the shared library are the first two arguments of the script that imports this.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

import fmpy
from fmpy.fmi1 import calloc, free
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)
from fmpy.fmi3 import FMU3Slave, fmi3LogMessageCallback

OLEO, LIBRARY = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
del sys.argv[1:3]
VERSIONS = (2, 3)


def oleo(*arguments):
    """Status, and what the program prints on either stream."""
    done = subprocess.run([OLEO, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class Fmu:
    """An FMU that the command line has written, unpacked."""

    def __init__(self, folder, kind, version, *arguments):
        self.version = version
        self.path = pathlib.Path(tempfile.mkdtemp(dir=folder)) / f"{kind}-{version}.fmu"
        status, said, complained = oleo(
            "fmu", kind, "--fmi", version, "--library", LIBRARY, "--out", self.path, *arguments
        )
        assert status == 0, complained
        self.said = said
        self.description = fmpy.read_model_description(str(self.path))
        self.unpacked = fmpy.extract(str(self.path))
        self.reference = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        self.kind = {variable.name: variable.type for variable in self.description.modelVariables}

    def close(self):
        shutil.rmtree(self.unpacked, ignore_errors=True)

    def instance(self, name="one", events=False):
        """A new instance, with the event mode of FMI 3 or without, and the lines that it logs."""
        kind = FMU2Slave if self.version == 2 else FMU3Slave
        slave = kind(
            guid=self.description.guid,
            unzipDirectory=self.unpacked,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        return Instance(self, slave, events)


class Instance:
    """One instance, with the differences between the versions put away."""

    def __init__(self, fmu, slave, events):
        self.fmu, self.slave, self.lines, self.time_s = fmu, slave, [], 0.0
        if fmu.version == 2:
            self.callbacks = fmi2CallbackFunctions()
            self.callbacks.logger = fmi2CallbackLoggerTYPE(
                lambda environment, name, status, category, message: self.lines.append(message.decode())
            )
            self.callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(calloc)
            self.callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(free)
            slave.instantiate(callbacks=self.callbacks)
        else:
            self.callbacks = fmi3LogMessageCallback(
                lambda environment, status, category, message: self.lines.append(message.decode())
            )
            slave.instantiate(logMessage=self.callbacks, eventModeUsed=events)

    def start(self, **values):
        """Sets values and makes the instance ready for a step."""
        if self.fmu.version == 2:
            self.slave.setupExperiment(startTime=0.0)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=0.0)
        self.set(**values)
        self.slave.exitInitializationMode()
        return self

    def set(self, **values):
        self.set_all(values)

    def set_all(self, values):
        """Sets variables by name, all of a kind at once."""
        real = self.slave.setReal if self.fmu.version == 2 else self.slave.setFloat64
        for function, names in [
            (self.slave.setBoolean, [name for name in values if self.fmu.kind[name] == "Boolean"]),
            (real, [name for name in values if self.fmu.kind[name] in ("Real", "Float64")]),
        ]:
            if names:
                function([self.fmu.reference[name] for name in names], [values[name] for name in names])

    def get(self, *names):
        """Values of variables by name."""
        functions = {"Boolean": self.slave.getBoolean}
        if self.fmu.version == 2:
            functions |= {"Real": self.slave.getReal, "Enumeration": self.slave.getInteger}
        else:
            functions |= {"Float64": self.slave.getFloat64, "Enumeration": self.slave.getInt64}
        found = {}
        for kind, function in functions.items():
            own = [name for name in names if self.fmu.kind[name] == kind]
            if own:
                found |= zip(own, function([self.fmu.reference[name] for name in own]))
        return tuple(found[name] for name in names)

    def step(self, step_s):
        self.slave.doStep(currentCommunicationPoint=self.time_s, communicationStepSize=step_s)
        self.time_s += step_s

    def written_state(self):
        """The state as bytes."""
        slave = self.slave
        if self.fmu.version == 2:
            state = slave.getFMUstate()
            written = slave.serializeFMUstate(state)
            slave.freeFMUstate(state)
        else:
            state = slave.getFMUState()
            written = slave.serializeFMUState(state)
            slave.freeFMUState(state)
        return bytes(written), self.time_s

    def read_state(self, written):
        """Goes on from what another instance has written."""
        slave, (written, self.time_s) = self.slave, written
        if self.fmu.version == 2:
            state = slave.deSerializeFMUstate(written)
            slave.setFMUstate(state)
            slave.freeFMUstate(state)
        else:
            state = slave.deserializeFMUState(written)
            slave.setFMUState(state)
            slave.freeFMUState(state)

    def free(self):
        self.slave.freeInstance()
