/* What `nendo run --to shm:NAME` shows in /dev/shm/nendo-NAME, for programs in C99 and C++.
 * /usr/share/doc/libnendo-dev/publish-format.md describes the same byte for byte. Map the file for
 * reading, judge it with nendo_publish_is_usable(), then copy what you want with the functions
 * below: the writer never waits for a reader, so a copy counts only if they return 1. They neither
 * block nor call the system. Needs GCC's or Clang's atomics. */
#ifndef NENDO_PUBLISH_H
#define NENDO_PUBLISH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wold-style-cast"
#endif

#define NENDO_PUBLISH_MAGIC "NENDOPUB" /* eight bytes, no NUL */
#define NENDO_PUBLISH_BYTE_ORDER 0x01020304u
#define NENDO_PUBLISH_MAJOR 1
#define NENDO_PUBLISH_MINOR 2

enum { NENDO_PUBLISH_LIVE = 1, NENDO_PUBLISH_ENDED = 2 };                   /* header.state */
enum { NENDO_PUBLISH_PRESENT = 1, NENDO_PUBLISH_SILENT = 2 };               /* hand.flags */
enum { NENDO_PUBLISH_HELD = 1, NENDO_PUBLISH_FIELDS_LEFT_OUT = 2 };         /* record.flags */
enum { NENDO_PUBLISH_KEEPS_VOLUME = 0x100, NENDO_PUBLISH_HALFWAY = 0x200 }; /* field.kernel */
enum { NENDO_PUBLISH_JOINTS = 26 };  /* in OpenXR's order (XR_EXT_hand_tracking) */
enum { NENDO_PUBLISH_ANGLES = 23 };  /* in the order of FORMAT.md */
enum {                               /* hand_state.flags */
       NENDO_PUBLISH_HAS_SWITCH = 1, /* the glove reports its wrist switch */
       NENDO_PUBLISH_SWITCH_ON = 2,
       NENDO_PUBLISH_TRACKED = 4, /* a tracker moves the wrist */
       NENDO_PUBLISH_LOST = 8     /* it delivers no good pose, and the wrist is frozen */
};

struct nendo_publish_header {
  char magic[8];
  uint32_t byte_order;
  uint16_t major, minor;
  uint64_t segment_bytes;
  uint32_t writer_pid;
  uint32_t vertices, triangles;
  uint32_t record_slots, shape_slots;
  uint32_t states_stride;                               /* of record_slots slots; 0 before 1.2 */
  uint64_t setup_offset, triangles_offset, rest_offset; /* triangles: 3 uint32_t, rest: 3 float */
  uint64_t records_offset, record_stride;
  uint64_t shapes_offset, shape_stride;
  int64_t created_monotonic_ns, created_realtime_ns;
  uint64_t states_offset; /* 0 before 1.2 */
  /* From here on it changes. */
  uint32_t state;
  uint32_t reserved2;
  uint64_t newest;      /* number of the newest record; the first is 1; 0: none yet */
  int64_t heartbeat_ns; /* CLOCK_MONOTONIC when the newest one's tick woke */
  uint64_t reserved3[5];
};

/* Of one loop; another loop writes it, the triangles and the rest shape again. */
struct nendo_publish_setup {
  uint64_t stage;      /* 2 * generation + 2: whole */
  uint64_t generation; /* from 1 */
  double origin[3];    /* vertex = origin + unit * (the three floats), in the model's units */
  double unit;
  double rate_hz;
  double units_per_metre; /* from the stage, on which the hands are, to the model */
  uint32_t mode;          /* at the beginning; 1: type-1, 2: type-2, 3: clay */
  uint32_t radii_offset;  /* 2 times 26 floats, in metres; 0 before 1.2 */
  double offset[3];       /* of a model far from zero: what all places lack to those of its file */
  uint64_t reserved1[4];
};

struct nendo_publish_joint {
  float position[3];    /* metres, on the stage */
  float orientation[4]; /* x y z w */
};

struct nendo_publish_hand {
  uint32_t flags;
  uint32_t reserved;
  uint64_t samples; /* received since the loop began */
  struct nendo_publish_joint joints[NENDO_PUBLISH_JOINTS];
};

/* Since 1.2: what glove and tracker report of a hand, and what it touches. */
struct nendo_publish_hand_state {
  uint32_t flags;
  uint32_t measured;                   /* bit k: a sensor measures angle k; others are estimates */
  int64_t sampled_ns;                  /* CLOCK_MONOTONIC when the newest sample was measured */
  int64_t tracked_ns;                  /* and the newest pose of the tracker; 0: none */
  double angles[NENDO_PUBLISH_ANGLES]; /* radians */
  struct nendo_publish_joint forearm;  /* its end, from which the wrist's angles turn the hand */
  float touch[6];                      /* thumb to little finger, palm: 0 none, 1 strongest */
  uint32_t reserved;
};

struct nendo_publish_states {
  uint64_t stage; /* 2 * number + 2: whole */
  uint64_t number;
  uint32_t model; /* its version, from 0; another one has other vertices */
  uint32_t reserved[3];
  struct nendo_publish_hand_state hands[2]; /* left, right */
};

struct nendo_publish_record {
  uint64_t stage; /* 2 * number + 2: whole */
  uint64_t number;
  uint64_t generation;
  uint64_t tick, ticks, missed, rest_changes, shape_jumps;
  int64_t scheduled_ns, woke_ns, since_last_ns; /* CLOCK_MONOTONIC */
  uint64_t shape_changes;                       /* the same as in another record: the same shape */
  double units_per_metre;
  uint32_t flags;
  uint32_t status; /* 0 ok, 1 merged, 2 singular, 3 too dense, 4 not finite */
  uint32_t mode;
  uint32_t fields;                    /* how many follow the record, one after another */
  uint64_t fields_bytes;              /* and how long they are together */
  struct nendo_publish_hand hands[2]; /* left, right */
};

struct nendo_publish_function {
  double centre[3];
  double radius;
  double coefficient[3];
};

/* s(x) = sum of coefficient * psi(|x - centre| / radius) + polynomial * (1, x, y, z). Since 1.1:
 * with NENDO_PUBLISH_KEEPS_VOLUME the kernel is a matrix, and there is no polynomial: its first
 * number is the share of clay, 0 to 1. */
struct nendo_publish_field {
  uint32_t kernel; /* Wendland 0 C0, 1 C2, 2 C4, 3 C6; and flags from bit 8 on */
  uint32_t functions;
  double polynomial[12]; /* three rows of four */
  /* struct nendo_publish_function[functions] */
};

struct nendo_publish_shape {
  uint64_t stage; /* 2 * number + 2: whole */
  uint64_t number;
  uint64_t shape_changes;
  uint64_t reserved[5];
  /* float[3 * vertices], in the mesh's order */
};

#define NENDO_PUBLISH_ASSERT(name, condition)                                                      \
  typedef char nendo_publish_assert_##name[(condition) ? 1 : -1] __attribute__((unused))
NENDO_PUBLISH_ASSERT(header, sizeof(struct nendo_publish_header) == 192);
NENDO_PUBLISH_ASSERT(changes, offsetof(struct nendo_publish_header, state) == 128);
NENDO_PUBLISH_ASSERT(setup, sizeof(struct nendo_publish_setup) == 128);
NENDO_PUBLISH_ASSERT(hand, sizeof(struct nendo_publish_hand) == 744);
NENDO_PUBLISH_ASSERT(hands, offsetof(struct nendo_publish_record, hands) == 128);
NENDO_PUBLISH_ASSERT(hand_state, sizeof(struct nendo_publish_hand_state) == 264);
NENDO_PUBLISH_ASSERT(states, sizeof(struct nendo_publish_states) == 560);
NENDO_PUBLISH_ASSERT(record, sizeof(struct nendo_publish_record) == 1616);
NENDO_PUBLISH_ASSERT(function, sizeof(struct nendo_publish_function) == 56);
NENDO_PUBLISH_ASSERT(field, sizeof(struct nendo_publish_field) == 104);
NENDO_PUBLISH_ASSERT(shape, sizeof(struct nendo_publish_shape) == 64);

static inline int nendo_publish_fits(uint64_t all, uint64_t offset, uint64_t count,
                                     uint64_t bytes) {
  return offset % 8 == 0 && offset <= all && (bytes == 0 || count <= (all - offset) / bytes);
}

/* 1 if `bytes` bytes at `base`, aligned to 8, are a segment that the functions below may read. */
static inline int nendo_publish_is_usable(const void* base, uint64_t bytes) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  if (bytes < sizeof *h || memcmp(h->magic, NENDO_PUBLISH_MAGIC, 8) != 0) return 0;
  if (h->byte_order != NENDO_PUBLISH_BYTE_ORDER || h->major != NENDO_PUBLISH_MAJOR) return 0;
  if (__atomic_load_n(&h->state, __ATOMIC_ACQUIRE) == 0) return 0;
  return h->segment_bytes <= bytes && h->record_slots > 0 && h->shape_slots > 0 &&
         h->record_stride >= sizeof(struct nendo_publish_record) && h->record_stride % 8 == 0 &&
         h->shape_stride >= sizeof(struct nendo_publish_shape) + 12 * (uint64_t)h->vertices &&
         h->shape_stride % 8 == 0 &&
         nendo_publish_fits(bytes, h->setup_offset, 1, sizeof(struct nendo_publish_setup)) &&
         nendo_publish_fits(bytes, h->triangles_offset, h->triangles, 12) &&
         nendo_publish_fits(bytes, h->rest_offset, h->vertices, 12) &&
         nendo_publish_fits(bytes, h->records_offset, h->record_slots, h->record_stride) &&
         (h->states_offset == 0 ||
          (h->states_stride >= sizeof(struct nendo_publish_states) && h->states_stride % 8 == 0 &&
           nendo_publish_fits(bytes, h->states_offset, h->record_slots, h->states_stride))) &&
         nendo_publish_fits(bytes, h->shapes_offset, h->shape_slots, h->shape_stride);
}

static inline uint64_t nendo_publish_newest(const void* base) {
  return __atomic_load_n(&((const struct nendo_publish_header*)base)->newest, __ATOMIC_RELAXED);
}
static inline uint32_t nendo_publish_state(const void* base) {
  return __atomic_load_n(&((const struct nendo_publish_header*)base)->state, __ATOMIC_ACQUIRE);
}

/* Multiples of four bytes, none of which is torn. */
static inline void nendo_publish_copy(void* to, const void* from, uint64_t bytes) {
  uint64_t at;
  for (at = 0; at + 4 <= bytes; at += 4) {
    const uint32_t word =
        __atomic_load_n((const uint32_t*)((const char*)from + at), __ATOMIC_RELAXED);
    memcpy((char*)to + at, &word, 4);
  }
}
static inline int nendo_publish_holds(const uint64_t* stage, uint64_t number) {
  return __atomic_load_n(stage, __ATOMIC_ACQUIRE) == 2 * number + 2;
}
static inline int nendo_publish_still_holds(const uint64_t* stage, uint64_t number) {
  __atomic_thread_fence(__ATOMIC_ACQUIRE);
  return __atomic_load_n(stage, __ATOMIC_RELAXED) == 2 * number + 2;
}

/* Copies record `number`, and at most `max_fields_bytes` of its fields (0:
 * none). 0: it is not there, or no longer. Both pointers aligned to 8. */
static inline int nendo_publish_read(const void* base, uint64_t number,
                                     struct nendo_publish_record* record, void* fields,
                                     uint64_t max_fields_bytes) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  const char* slot =
      (const char*)base + h->records_offset + number % h->record_slots * h->record_stride;
  uint64_t bytes = h->record_stride - sizeof *record;
  if (number == 0 || !nendo_publish_holds((const uint64_t*)slot, number)) return 0;
  nendo_publish_copy(record, slot, sizeof *record);
  if (bytes > record->fields_bytes) bytes = record->fields_bytes;
  if (bytes > max_fields_bytes) bytes = max_fields_bytes;
  nendo_publish_copy(fields, slot + sizeof *record, bytes);
  return nendo_publish_still_holds((const uint64_t*)slot, number);
}

/* Copies the states of both hands that belong to record `number`. 0: it is not there, or no longer,
 * or the writer is older than 1.2. */
static inline int nendo_publish_read_states(const void* base, uint64_t number,
                                            struct nendo_publish_states* states) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  const char* slot;
  if (h->states_offset == 0 || number == 0) return 0;
  slot = (const char*)base + h->states_offset + number % h->record_slots * h->states_stride;
  if (!nendo_publish_holds((const uint64_t*)slot, number)) return 0;
  nendo_publish_copy(states, slot, sizeof *states);
  return nendo_publish_still_holds((const uint64_t*)slot, number);
}

/* Copies the shape that belongs to record `number`: 3 * header.vertices floats. Origin and unit are
 * those of that record's generation; another setup may have come since. */
static inline int nendo_publish_read_shape(const void* base, uint64_t number, float* vertices) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  const char* slot =
      (const char*)base + h->shapes_offset + number % h->shape_slots * h->shape_stride;
  if (number == 0 || !nendo_publish_holds((const uint64_t*)slot, number)) return 0;
  nendo_publish_copy(vertices, slot + sizeof(struct nendo_publish_shape),
                     12 * (uint64_t)h->vertices);
  return nendo_publish_still_holds((const uint64_t*)slot, number);
}

/* Copies what belongs to the loop; `triangles` (3 * header.triangles) and `rest` (3 *
 * header.vertices) may be null. */
static inline int nendo_publish_read_setup(const void* base, struct nendo_publish_setup* setup,
                                           uint32_t* triangles, float* rest) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  const char* from = (const char*)base + h->setup_offset;
  nendo_publish_copy(setup, from, sizeof *setup);
  if (setup->generation == 0 || !nendo_publish_holds((const uint64_t*)from, setup->generation))
    return 0;
  nendo_publish_copy(setup, from, sizeof *setup);
  if (triangles != NULL)
    nendo_publish_copy(triangles, (const char*)base + h->triangles_offset,
                       12 * (uint64_t)h->triangles);
  if (rest != NULL)
    nendo_publish_copy(rest, (const char*)base + h->rest_offset, 12 * (uint64_t)h->vertices);
  return nendo_publish_still_holds((const uint64_t*)from, setup->generation);
}

/* Copies the radii of the flesh about the joints of the left hand and of the right one; 0 of a hand
 * that no glove drives. 0: the writer is older than 1.2, or a setup is being written. */
static inline int nendo_publish_read_radii(const void* base, float radii[2][NENDO_PUBLISH_JOINTS]) {
  const struct nendo_publish_header* h = (const struct nendo_publish_header*)base;
  struct nendo_publish_setup setup;
  if (!nendo_publish_read_setup(base, &setup, NULL, NULL) || setup.radii_offset == 0 ||
      !nendo_publish_fits(h->segment_bytes, setup.radii_offset, 2, 4 * NENDO_PUBLISH_JOINTS))
    return 0;
  nendo_publish_copy(radii, (const char*)base + setup.radii_offset, 8 * NENDO_PUBLISH_JOINTS);
  return nendo_publish_still_holds((const uint64_t*)((const char*)base + h->setup_offset),
                                   setup.generation);
}

#ifdef __cplusplus
#pragma GCC diagnostic pop
}
#endif

#endif
