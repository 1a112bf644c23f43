//! Scenes with area lights, shaded by LTC on the CPU or GPU, or by the reference integrator.
