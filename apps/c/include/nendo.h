/* Gloves, hands and shapes for programs in C99, and for all that call C: Unity, Rust, Go, Julia.
 * Link with libnendo_c.so.1 (pkg-config nendo-c). A program that was built with one version 1.x of
 * this interface runs with every later one.
 *
 * Functions that return an int return a nendo_status: NENDO_OK, or an error, of which
 * nendo_message() has a line for the user. Pointers must not be null unless a comment says so. An
 * object may be used by one thread at a time; different objects by different threads. */
#ifndef NENDO_H
#define NENDO_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

enum nendo_status {
  NENDO_OK = 0,
  NENDO_FAILED = 1,
  NENDO_USAGE = 2,         /* an argument is wrong */
  NENDO_NO_DEVICE = 3,     /* no such glove, or it does not answer like one */
  NENDO_NO_PERMISSION = 4, /* the device may not be opened */
  NENDO_BAD_INPUT = 5      /* a file cannot be used */
};
enum { NENDO_LEFT = 0, NENDO_RIGHT = 1 };
enum {
  NENDO_JOINTS = 26, /* in OpenXR's order (XR_EXT_hand_tracking): palm, wrist, thumb, ... */
  NENDO_ANGLES = 23  /* in the order of `nendo.ANGLE_NAMES` in Python, and of FORMAT.md */
};
enum {                    /* nendo_hand.flags */
       NENDO_PRESENT = 1, /* a glove drives the hand; without this flag, all is zero */
       NENDO_SILENT = 2,  /* the glove sends nothing, and the pose is frozen */
       NENDO_TRACKED = 4, /* a tracker moves the wrist */
       NENDO_LOST = 8     /* it delivers no good pose, and the wrist is frozen */
};

struct nendo_joint {
  float position[3];    /* metres: x to the operator's right, y up, z towards the operator */
  float orientation[4]; /* x y z w; fingers point along -z, the back of the hand along y */
};

struct nendo_hand {
  uint32_t flags;
  uint32_t side;               /* NENDO_LEFT or NENDO_RIGHT */
  uint64_t samples;            /* received so far */
  double time_s;               /* when the newest one was measured, by CLOCK_MONOTONIC */
  double angles[NENDO_ANGLES]; /* radians */
  struct nendo_joint joints[NENDO_JOINTS];
};

/* Returns the version of Nendo, such as "0.2.0". */
const char* nendo_version(void);
/* Returns one line about the last error of this thread, which names what failed and the remedy; ""
 * without one. Valid until the thread's next call. */
const char* nendo_message(void);

/* --- gloves and their hands ------------------------------------------------------------------ */

typedef struct nendo_glove nendo_glove;

/* Calls `found` with the GLOVE of nendo_glove_open() and a description for each device that may be
 * a glove, before it returns. Blocks for less than a second. */
int nendo_find_gloves(void (*found)(void* context, const char* glove, const char* description),
                      void* context);

/* Opens a GLOVE of `nendo run` and starts it: "auto", "auto:left", "serial:/dev/ttyUSB0",
 * "sim:grasp", "replay:take.nendo". `user` is the wearer whose stored calibration is used; null:
 * the stored one for this glove. Blocks for up to 7 s. */
int nendo_glove_open(const char* glove, const char* user, nendo_glove** opened);
/* Stops and closes it. Null is allowed. */
void nendo_glove_close(nendo_glove* glove);
/* Returns the model that the glove reports; valid until it is closed. */
const char* nendo_glove_model(const nendo_glove* glove);
/* Writes the hand of the newest sample, with the forearm's end at the origin. Wait-free: the hand
 * is the same as before if there is no newer sample. */
int nendo_glove_hand(nendo_glove* glove, struct nendo_hand* hand);

/* --- deforming vertices ----------------------------------------------------------------------- */

typedef struct nendo_deformer nendo_deformer;

/* Makes a deformer of the paper's type 1 for `vertices` points, three numbers each, of which those
 * within `radius` of a control point move with it. `kernel`: "wendland-c2", or c0, c4, c6; null:
 * c2. Points and radius are in one unit of the caller's. */
int nendo_deformer_make(const double* vertices, size_t vertex_count, size_t control_points,
                        double radius, const char* kernel, nendo_deformer** made);
void nendo_deformer_free(nendo_deformer* deformer); /* null is allowed */
/* Grabs the rest shape at the control points, three numbers each. */
int nendo_deformer_grab(nendo_deformer* deformer, const double* points);
/* Deforms the rest shape so that the grabbed points move to `points`, and writes the vertices. */
int nendo_deformer_move(nendo_deformer* deformer, const double* points, double* vertices);
/* Makes the last result the rest shape, and grabs it at `points`. */
int nendo_deformer_commit(nendo_deformer* deformer, const double* points);

/* --- a loop: gloves shape a model, as in `nendo run` -------------------------------------------
 */

typedef struct nendo_loop nendo_loop;

/* Zero, or a null pointer, is the value that `nendo run` has without the option. */
struct nendo_loop_options {
  const char *left, *right; /* GLOVEs; both null: those of this machine, or simulated hands */
  const char* user;
  const char* mode; /* "type1", "type2", "clay" or "parts" */
  double rate_hz;
  double model_size_m;  /* the longest side of the model on the stage */
  double radius_m;      /* of the fingertips, on the stage */
  uint32_t priority;    /* 1 to 97 asks for real-time rights */
  uint32_t reserved[7]; /* zero */
};

/* Opens the gloves and starts the loop on a thread of its own. `options` may be null. Blocks for
 * some seconds. */
int nendo_loop_begin(const char* model_file, const struct nendo_loop_options* options,
                     nendo_loop** begun);
/* Does the same with a model of the caller: three numbers for each vertex, and three indices of
 * vertices for each triangle. */
int nendo_loop_begin_with(const double* vertices, size_t vertex_count, const uint32_t* triangles,
                          size_t triangle_count, const struct nendo_loop_options* options,
                          nendo_loop** begun);
/* Stops loop and gloves. Null is allowed. */
void nendo_loop_end(nendo_loop* loop);

size_t nendo_loop_vertex_count(const nendo_loop* loop);
size_t nendo_loop_triangle_count(const nendo_loop* loop);
/* Writes three indices of vertices for each triangle. */
void nendo_loop_triangles(const nendo_loop* loop, uint32_t* triangles);

/* Takes the newest frame, and returns whether it is a new one: 1 or 0. Call it at least once for
 * each picture: it also prepares undos. Never waits for the loop. */
int nendo_loop_update(nendo_loop* loop);
/* Return what the frame of the last update has. Hands: left, right, on the stage. Vertices: three
 * numbers each, in the model's units. */
void nendo_loop_hands(nendo_loop* loop, struct nendo_hand hands[2]);
void nendo_loop_vertices(nendo_loop* loop, double* vertices);
double
nendo_loop_units_per_metre(const nendo_loop* loop); /* of the model, per metre of the stage */

enum nendo_request {
  NENDO_GRAB = 0,
  NENDO_RELEASE = 1, /* the hands release the model; the shape stays */
  NENDO_COMMIT = 2,  /* the shape becomes the rest shape, and the hands hold it again */
  NENDO_UNDO = 3,
  NENDO_REDO = 4,
  NENDO_RESET = 5, /* restores the loaded model */
  NENDO_REGRAB = 6 /* hands that hold the model grab it again where they are, without a commit */
};
/* Asks for a nendo_request at the next tick. */
int nendo_loop_ask(nendo_loop* loop, int request);
/* Changes a setting from the next tick on, by its name and value in text, as in a timeline: "mode"
 * "type2", "radius_m" "0.05", "injective" "true". */
int nendo_loop_change(nendo_loop* loop, const char* setting, const char* value);
/* Returns whether all gloves are recordings that have ended: 1 or 0. */
int nendo_loop_has_ended(const nendo_loop* loop);
/* Stops the loop and writes the shaped model to a file: .obj, .ply, .stl or .glb. Afterwards only
 * nendo_loop_end() may be called. */
int nendo_loop_save(nendo_loop* loop, const char* file);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif

#endif
