// A hand's skin: the open hand's, moved by the joints that carry a place, mixed as dual quaternions.
layout(location = 0) in vec3 rest_place;
layout(location = 1) in vec3 rest_normal;
layout(location = 2) in uvec4 carriers;
layout(location = 3) in vec4 shares;
uniform vec4 turns[26];   // of a joint since the open hand
uniform vec4 shifts[26];  // half of its way, times its turn

void main() {
  vec4 turn = vec4(0.0), shift = vec4(0.0);
  for (int rank = 0; rank < 4; ++rank) {
    turn += shares[rank] * turns[carriers[rank]];
    shift += shares[rank] * shifts[carriers[rank]];
  }
  float twice = 2.0 / dot(turn, turn);
  vec3 v = turn.xyz, s = shift.xyz;
  draw_at(rest_place + twice * (cross(v, cross(v, rest_place) + turn.w * rest_place) + turn.w * s - shift.w * v + cross(v, s)),
          rest_normal + twice * cross(v, cross(v, rest_normal) + turn.w * rest_normal));
}
