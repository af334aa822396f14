layout(location = 0) in vec3 given_place;

void main() { draw_at(given_place, vec3(0.0, 1.0, 0.0)); }
