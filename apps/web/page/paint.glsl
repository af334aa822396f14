// The model's own colours: of a material, of the vertices, of a picture.
uniform vec3 colour;
uniform sampler2D picture;
uniform bool textured;
in vec2 texcoord;
in vec3 tint;
vec3 own_colour() {
  // Its rows begin at the top, and texture coordinates at the bottom.
  vec3 seen = texture(picture, vec2(texcoord.x, 1.0 - texcoord.y)).rgb;
  return textured ? colour * tint * seen : colour * tint;
}
