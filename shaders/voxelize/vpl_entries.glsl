// Headers and VPLs of the tree where they are written (shaders/transport/vpls.glsl).

layout(std430, binding = kTreeRecords) buffer Records { vec4 records[]; };

void storeVpl(uint record, Vpl v) {
  const int at = int(record) * kRecordTexels;
  records[at] = vec4(v.position, v.area);
  records[at + 1] = vec4(v.direction, v.spread);
  const mat3 e = v.extent;
  records[at + 2] = vec4(e[0][0], e[1][1], e[2][2], e[0][0] + e[1][1] + e[2][2]);
  records[at + 3] = vec4(e[0][1], e[0][2], e[1][2], 0.0);
#if LPV_TEXTURED
  records[at + 4] = vec4(v.colour, 0.0);
#endif
}

Vpl vplAt(uint record) {
  const int at = int(record) * kRecordTexels;
  Vpl v;
  v.position = records[at].xyz;
  v.area = records[at].w;
  v.direction = records[at + 1].xyz;
  v.spread = records[at + 1].w;
  const vec3 d = records[at + 2].xyz, o = records[at + 3].xyz;
  v.extent = mat3(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z);
#if LPV_TEXTURED
  v.colour = records[at + 4].rgb;
#endif
  return v;
}
