#import bevy_core_pipeline::tonemapping::somewhat_boring_display_transform
#import bevy_pbr::forward_io::VertexOutput

// The colors of the vertices, with the cameras' tonemapping.
@fragment
fn fragment(in: VertexOutput) -> @location(0) vec4<f32> {
    return vec4(somewhat_boring_display_transform(in.color.rgb), 1.0);
}
