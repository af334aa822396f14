/* Gloves shape a model for two seconds: sculpt MODEL OUT [LEFT [RIGHT]], gloves as in `nendo run`.
 *   cc -std=c99 sculpt.c $(pkg-config --cflags --libs nendo-c) -o sculpt */

#define _POSIX_C_SOURCE 199309L

#include <stdio.h>
#include <string.h>
#include <time.h>

#include <nendo.h>

static int fail(int status) {
  fprintf(stderr, "sculpt: %s\n", nendo_message());
  return status;
}

int main(int argc, char** argv) {
  enum { index_tip = 10 }; /* OpenXR's number */
  const struct timespec picture = {0, 16666667};
  struct nendo_loop_options options;
  nendo_loop* loop = NULL;
  int status, look;
  if (argc < 3) {
    fprintf(stderr, "sculpt: usage: sculpt MODEL OUT [LEFT [RIGHT]]\n");
    return NENDO_USAGE;
  }
  memset(&options, 0, sizeof options);
  options.left = argc > 3 ? argv[3] : NULL;
  options.right = argc > 4 ? argv[4] : NULL;
  status = nendo_loop_begin(argv[1], &options, &loop);
  if (status != NENDO_OK) return fail(status);
  for (look = 0; look < 120 && !nendo_loop_has_ended(loop); ++look) {
    if (nendo_loop_update(loop) && look % 30 == 0) {
      struct nendo_hand hands[2];
      int side;
      nendo_loop_hands(loop, hands);
      for (side = 0; side < 2; ++side)
        if (hands[side].flags & NENDO_PRESENT)
          printf("%s index finger at %.3f %.3f %.3f m\n", side == NENDO_LEFT ? "left" : "right",
                 hands[side].joints[index_tip].position[0], hands[side].joints[index_tip].position[1],
                 hands[side].joints[index_tip].position[2]);
    }
    nanosleep(&picture, NULL);
  }
  status = nendo_loop_save(loop, argv[2]);
  if (status != NENDO_OK) fail(status);
  nendo_loop_end(loop);
  return status;
}
