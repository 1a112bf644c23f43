//! Shaders for the service, as `ltc shader` writes them.

use std::str::FromStr;

use ltc_service::{ShaderFile, ShaderRefusal, ShaderSource};
use ltc_shade_gpu::{Code, Feature, Language, LightKind, ShaderRequest};

/// What a shader has unless its features are named: light from below the ground and behind the lobe is cut off.
pub const USUAL: &str = "surface-horizon,cosine-horizon";

/// Every language of `ltc-shade-gpu`.
pub struct Shaders;

impl ShaderSource for Shaders {
    fn languages(&self) -> Vec<&'static str> {
        Language::ALL.map(Language::name).to_vec()
    }

    fn shader(
        &self,
        language: &str,
        lights: &str,
        features: Option<&str>,
    ) -> Result<ShaderFile, ShaderRefusal> {
        let refusal = |field: &'static str, reason: String| ShaderRefusal { field, reason };
        let language: Language = language.parse().map_err(|e| refusal("lang", format!("{e}")))?;
        let lights: Vec<LightKind> = names(lights).map_err(|e| refusal("lights", e))?;
        let features: Vec<Feature> = names(features.unwrap_or(USUAL)).map_err(|e| refusal("features", e))?;
        let exported = ShaderRequest::new(lights, features).export(language);
        let exported = exported.map_err(|e| refusal("lights", format!("cannot be served: {e}")))?;
        let is_text = matches!(exported.code, Code::Text(_));
        Ok(ShaderFile { bytes: exported.bytes(), extension: language.extension(), is_text })
    }
}

/// Names between commas.
fn names<T: FromStr<Err: std::fmt::Display>>(text: &str) -> Result<Vec<T>, String> {
    let named = text.split(',').map(str::trim).filter(|name| !name.is_empty());
    named.map(|name| name.parse().map_err(|e: T::Err| format!("cannot be read: {e}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_served_is_what_the_verb_writes() {
        let served = Shaders.shader("glsl", "quad, line", Some("isotropic,fresnel")).unwrap();
        let request =
            ShaderRequest::new([LightKind::Quad, LightKind::Line], [Feature::Isotropic, Feature::Fresnel]);
        assert_eq!(served.bytes, request.export(Language::Glsl).unwrap().bytes());
        assert!(served.is_text && !Shaders.shader("spirv", "quad", None).unwrap().is_text);
    }

    #[test]
    fn refusals_say_which_parameter_and_what_there_is() {
        for (lights, features, field, word) in [
            ("candle", None, "lights", "quad"),
            ("quad", Some("sparkle"), "features", "fresnel"),
            ("", Some(""), "lights", "nothing was asked for"),
        ] {
            let refusal = Shaders.shader("wgsl", lights, features).unwrap_err();
            assert_eq!(refusal.field, field);
            assert!(refusal.reason.contains(word), "{}", refusal.reason);
        }
    }
}
