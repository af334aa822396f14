// One colour for all.
uniform vec3 colour;
vec3 own_colour() { return colour; }
