"""A mount as somebody else would write it: a spring and a damper under a given motion, exported by PythonFMU."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class SlidingMount(Fmi2Slave):
    """Force over displacement and speed."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.displacement_m = 0.0
        self.speed_m_s = 0.0
        self.force_N = 0.0
        self.stiffness_N_m = 2.0e4
        self.viscous_N_s_m = 300.0
        for name in ("displacement_m", "speed_m_s"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        self.register_variable(Real("force_N", causality=Fmi2Causality.output))
        for name in ("stiffness_N_m", "viscous_N_s_m"):
            tunable = {"causality": Fmi2Causality.parameter, "variability": Fmi2Variability.tunable}
            self.register_variable(Real(name, **tunable))

    def do_step(self, current_time, step_size):
        """Nothing is remembered."""
        del current_time, step_size
        self.force_N = self.stiffness_N_m * self.displacement_m + self.viscous_N_s_m * self.speed_m_s
        return True
