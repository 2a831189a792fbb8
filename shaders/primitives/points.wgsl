// A point larger than a pixel is one quad that faces the screen.

const VERTICES_PER_RECORD: u32 = 4u;

fn amplified_vertex(instance: Instance) -> SplatVertex {
    return point_vertex(fetch_point(instance), vertex_of_record(instance));
}
