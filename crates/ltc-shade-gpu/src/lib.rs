//! LTC area lights on the GPU through wgpu.
