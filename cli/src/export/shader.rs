//! Languages of shader functions.

/// Shading languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShaderLanguage {
    /// GLSL 3.30 or ES 3.00.
    Glsl,
    /// HLSL, shader model 4 or newer.
    Hlsl,
    /// WGSL.
    Wgsl,
}
