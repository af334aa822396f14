// Takes a vertex and its normal through the fields in a texture: of each field a texel
// (functions, kernel, has a polynomial, share of clay and 2 more if it is halfway), three of the
// polynomial's rows if it has one, and two a function (centre and 1 / radius; coefficient). A field
// that is halfway says where the next is asked. Normals turn by the cofactors of the Jacobian.
layout(location = 0) in vec3 base_place;
layout(location = 1) in vec3 base_normal;
uniform highp sampler2D fields; // 256 texels wide
uniform int field_count;

vec4 texel(int at) { return texelFetch(fields, ivec2(at & 255, at >> 8), 0); }

// psi(t) and psi'(t) / t, for t < 1.
vec2 wendland(int kernel, float t) {
  float u = 1.0 - t, u2 = u * u;
  if (kernel == 0) return vec2(u2, -2.0 * u / max(t, 1e-4));
  if (kernel == 1) return vec2(u2 * u2 * (4.0 * t + 1.0), -20.0 * u2 * u);
  if (kernel == 2)
    return vec2(u2 * u2 * u2 * ((35.0 * t + 18.0) * t + 3.0) / 3.0, -56.0 / 3.0 * u2 * u2 * u * (5.0 * t + 1.0));
  return vec2(u2 * u2 * u2 * u2 * (((32.0 * t + 25.0) * t + 8.0) * t + 1.0),
              -22.0 * u2 * u2 * u2 * u * ((16.0 * t + 7.0) * t + 1.0));
}

void deform(inout vec3 place, inout vec3 normal) {
  int at = 0;
  vec3 asked = place;
  mat3 ahead = mat3(1.0); // of `asked`, by `place`
  for (int field = 0; field < field_count; ++field) {
    vec4 head = texel(at++);
    vec3 s = vec3(0.0);
    mat3 slope = mat3(0.0);
    if (head.z > 0.0) {
      vec4 x = texel(at), y = texel(at + 1), z = texel(at + 2);
      at += 3;
      vec4 one = vec4(1.0, asked);
      s = vec3(dot(x, one), dot(y, one), dot(z, one));
      slope = transpose(mat3(x.yzw, y.yzw, z.yzw));
    }
    int functions = int(head.x), kernel = int(head.y);
    bool halfway = head.w >= 2.0;
    float clay = halfway ? head.w - 2.0 : head.w;
    for (int function = 0; function < functions; ++function, at += 2) {
      vec4 centre = texel(at);
      vec3 u = (asked - centre.xyz) * centre.w;
      float t = length(u);
      if (t >= 1.0) continue;
      vec3 coefficient = texel(at + 1).xyz;
      vec2 psi = wendland(kernel, t);
      if (clay > 0.0) {
        // (A I + B u u^T) a with its derivative, where A' / t is in psi.y.
        float o = 1.0 - t, o3 = clay * o * o * o, b = 15.0 * o3 * o, along = dot(u, coefficient);
        psi = (1.0 - clay) * psi + o3 * vec2(o * (1.0 + t * (4.0 - 20.0 * t)), -60.0 * (1.0 - 2.0 * t));
        s += b * along * u;
        vec3 steep = (t > 1e-4 ? -60.0 * o3 / t * along : 0.0) * u;
        slope += (outerProduct(steep, u) + b * outerProduct(u, coefficient) + b * along * mat3(1.0)) * centre.w;
      }
      s += coefficient * psi.x;
      slope += outerProduct(coefficient, u * (psi.y * centre.w));
    }
    if (halfway) {
      asked = place + s;
      ahead = mat3(1.0) + slope;
      continue;
    }
    place += s;
    asked = place;
    mat3 jacobian = mat3(1.0) + slope * ahead;
    ahead = mat3(1.0);
    vec3 turned = mat3(cross(jacobian[1], jacobian[2]), cross(jacobian[2], jacobian[0]),
                       cross(jacobian[0], jacobian[1])) * normal;
    float size = length(turned);
    if (size > 0.0) normal = turned / size;
  }
}
