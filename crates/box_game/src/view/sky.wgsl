#import bevy_core_pipeline::tonemapping::{screen_space_dither, somewhat_boring_display_transform}
#import bevy_pbr::forward_io::VertexOutput
#import bevy_render::maths::powsafe

// The colors of the vertices, with the tonemapping and the dither that the standard material has.
@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    var color = somewhat_boring_display_transform(in.color.rgb);
#ifdef DEBAND_DITHER
    color = powsafe(powsafe(color, 1.0 / 2.2) + screen_space_dither(in.position.xy), 2.2);
#endif
    return vec4(color, 1.0);
}
