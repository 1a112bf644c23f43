// The lookup that a TABLE_ constant names. Needs: table_constants, tables_exact, tables_hardware or tables_buffer; with baked slices
// baked_exact, baked_hardware or baked_buffer.

fn look_up(table: u32, wo: vec3f, alpha_x: f32, alpha_y: f32) -> LtcLookup {
    if table == TABLE_ISOTROPIC {
        return lookup_isotropic(wo, alpha_x);
    }
//#if baked
    if table >= TABLE_FIRST_SLICE {
        return lookup_baked(wo, alpha_x, alpha_y, table - TABLE_FIRST_SLICE);
    }
//#endif
    return lookup_anisotropic(wo, alpha_x, alpha_y);
}
