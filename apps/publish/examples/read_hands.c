/* Prints, a line each, where both index fingertips are (metres), from every tick that
 * `nendo run --to shm:NAME` shows; ends with the run, also with one that is killed.
 *   cc -std=c99 -o read_hands read_hands.c && ./read_hands NAME */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <nendo_publish.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { INDEX_TIP = 10, PATIENCE = 1000 /* pauses without a record */ };

static void print(const struct nendo_publish_record* record) {
  const char* names[] = {"left", "right"};
  int side;
  printf("{\"number\":%llu,\"tick\":%llu", (unsigned long long)record->number,
         (unsigned long long)record->tick);
  for (side = 0; side < 2; ++side) {
    const struct nendo_publish_hand* hand = &record->hands[side];
    const float* at = hand->joints[INDEX_TIP].position;
    if (hand->flags & NENDO_PUBLISH_PRESENT)
      printf(",\"%s\":[%.9g,%.9g,%.9g]", names[side], at[0], at[1], at[2]);
  }
  printf("}\n");
}

/* The run holds a lock on the file for as long as it lives. */
static int has_writer(int file) {
  struct flock lock = {0};
  lock.l_type = F_RDLCK;
  lock.l_whence = SEEK_SET;
  return fcntl(file, F_GETLK, &lock) != 0 || lock.l_type != F_UNLCK;
}

int main(int argc, char** argv) {
  char path[256];
  struct stat status;
  struct nendo_publish_record record;
  uint64_t next = 1, newest;
  const struct timespec pause = {0, 1000000};
  const void* base;
  int file, ended, pauses = 0;
  snprintf(path, sizeof path, "/dev/shm/nendo-%s", argc > 1 ? argv[1] : "run");
  file = open(path, O_RDONLY);
  if (file < 0 || fstat(file, &status) != 0 || status.st_size == 0) return perror(path), 1;
  base = mmap(NULL, (size_t)status.st_size, PROT_READ, MAP_SHARED, file, 0);
  if (base == MAP_FAILED) return perror(path), 1;
  if (!nendo_publish_is_usable(base, (uint64_t)status.st_size))
    return fprintf(stderr, "%s: not a segment of version %d\n", path, NENDO_PUBLISH_MAJOR), 1;
  for (;;) {
    ended = nendo_publish_state(base) == NENDO_PUBLISH_ENDED ||
            (pauses > PATIENCE && !has_writer(file));
    newest = nendo_publish_newest(base);
    pauses = next <= newest ? 0 : pauses + 1;
    for (; next <= newest; ++next) /* what it was too late for is passed over */
      if (nendo_publish_read(base, next, &record, NULL, 0)) print(&record);
    fflush(stdout);
    if (ended) return 0;
    nanosleep(&pause, NULL);
  }
}
