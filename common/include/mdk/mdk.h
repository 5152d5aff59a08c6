/* mdk in C99: rays against moving meshes, each ray at its own time (docs/library.md).
 *
 * A model is an animated mesh whose structures hold at every time: nothing is rebuilt when time
 * advances, and any number of threads may ask at once. Every function that returns mdk_status
 * returns MDK_OK, or an error and a sentence in mdk_last_error(); outputs are not written then,
 * unless it says so. No function crashes on numbers: what is not finite, or is not there, is an
 * error that names the argument. Pointers must be valid, and lists as long as is said.
 *
 * Structs begin with their size, so that they can grow: set each up by its *_init function.
 * Coordinates are floats in the units of the mesh, times are seconds of a clip in double.
 */
#ifndef MDK_MDK_H
#define MDK_MDK_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define MDK_API __attribute__((visibility("default")))
#else
#define MDK_API
#endif

/* ---- errors ---------------------------------------------------------------------------------- */

typedef int32_t mdk_status;
enum {
  MDK_OK = 0,
  MDK_ERROR_INTERNAL = 1,  /* a bug in this library, or no memory */
  MDK_ERROR_USAGE = 2,     /* an argument that cannot be */
  MDK_ERROR_BAD_INPUT = 3, /* a file's or mesh's content cannot be used */
  MDK_ERROR_IO = 4,        /* a file cannot be read or written */
  MDK_ERROR_OVER_LIMIT = 5 /* over a limit that is built in */
};

/* What was wrong with this thread's last call that failed: one sentence. Valid until the thread's
 * next failure; "" before the first one. */
MDK_API const char* mdk_last_error(void);

/* "MAJOR.MINOR.PATCH" of the library. The ABI is stable within libmdk.so.0. */
MDK_API const char* mdk_version(void);

/* ---- models ---------------------------------------------------------------------------------- */

typedef struct mdk_model mdk_model;

#define MDK_NONE 0xFFFFFFFFu /* no triangle, instance or material */

/* What becomes of a time outside of the clip, which lasts D seconds. */
typedef int32_t mdk_wrap;
enum {
  MDK_WRAP_LOOP = 0,     /* begins again every D seconds */
  MDK_WRAP_ONCE = 1,     /* stands at the clip's first or last key */
  MDK_WRAP_PING_PONG = 2 /* runs forwards, then backwards */
};

/* Maps and checks a .mdk file, which must not change while the model lives. Cost: a pass over its
 * tables; the bulk is read when rays need it. */
MDK_API mdk_status mdk_model_load(const char* path, mdk_model** model);

/* Models are counted: each load, bake or retain needs one release. NULL is ignored. */
MDK_API void mdk_model_retain(mdk_model* model);
MDK_API void mdk_model_release(mdk_model* model);

/* Writes the model as a .mdk file, whole or not at all. */
MDK_API mdk_status mdk_model_save(const mdk_model* model, const char* path);

typedef struct mdk_model_info {
  size_t struct_size;
  uint32_t vertex_count, triangle_count, key_count, clip_count, cluster_count, material_count;
  float bounds_low[3], bounds_high[3]; /* hold the mesh at every time of all clips */
} mdk_model_info;
MDK_API void mdk_model_info_init(mdk_model_info* info);
MDK_API mdk_status mdk_model_get_info(const mdk_model* model, mdk_model_info* info);

typedef struct mdk_clip_info {
  size_t struct_size;
  const char* name; /* UTF-8; lives as long as the model */
  double seconds;   /* from 0, its first key, to its last key */
  uint32_t first_key, key_count;
  float bounds_low[3], bounds_high[3]; /* hold the mesh at every time of the clip */
} mdk_clip_info;
MDK_API void mdk_clip_info_init(mdk_clip_info* info);
MDK_API mdk_status mdk_model_get_clip(const mdk_model* model, uint32_t clip, mdk_clip_info* info);
/* The first clip of this name. */
MDK_API mdk_status mdk_model_find_clip(const mdk_model* model, const char* name, uint32_t* clip);
/* Seconds of a clip's keys: key_count numbers. */
MDK_API mdk_status mdk_model_get_key_times(const mdk_model* model, uint32_t clip, double* seconds);

/* Linear RGBA of a material, without texture and vertex colours: 4 floats. */
MDK_API mdk_status mdk_model_get_material_color(const mdk_model* model, uint32_t material,
                                                float* rgba);

/* Corners of all triangles, counter-clockwise from outside: 3 * triangle_count numbers below
 * vertex_count. Hits count triangles in this order. */
MDK_API mdk_status mdk_model_get_faces(const mdk_model* model, uint32_t* faces);
/* The number that each triangle had in the mesh that was baked: triangle_count numbers. Corners
 * keep their order, so barycentric coordinates hold there, too; vertices may be joined and
 * reordered. */
MDK_API mdk_status mdk_model_get_source_triangles(const mdk_model* model, uint32_t* triangles);
/* Where the vertices are, as they are traced: 3 * vertex_count floats. Cost: O(vertices). */
MDK_API mdk_status mdk_model_get_vertices(const mdk_model* model, uint32_t clip, double seconds,
                                          mdk_wrap wrap, float* xyz);

/* Builds what rays need, which else the first cast does. Cost: O(T log T) in parallel. */
MDK_API mdk_status mdk_model_prepare(mdk_model* model);
/* Bytes that rays need at present, beside the mapped file; builds what they need. */
MDK_API mdk_status mdk_model_get_ray_bytes(mdk_model* model, size_t* bytes);

/* ---- rays ------------------------------------------------------------------------------------ */

/* Rays: origin + t direction, for t in (t_min, t_max]. Each list has a stride in bytes from one
 * item to the next; stride 0 gives every ray the first item. A ray without a direction hits nothing;
 * an origin, direction or time that is not finite, or a t_min or t_max that is NaN, is an error. */
typedef struct mdk_rays {
  size_t struct_size;
  size_t count;            /* fewer than 2^32 */
  const float* origins;    /* 3 floats each */
  const float* directions; /* 3 floats each, of any length but 0; t counts in this length */
  const float* t_min;      /* NULL: 0 */
  const float* t_max;      /* NULL: infinite */
  const double* times;     /* seconds; NULL: 0 */
  const uint32_t* masks;   /* instances of a scene are met where theirs shares a bit; NULL: all */
  size_t origin_stride, direction_stride, t_min_stride, t_max_stride, time_stride, mask_stride;
  uint32_t clip;
  mdk_wrap wrap;
  uint32_t threads; /* of this call, the calling one among them; 0: all cores */
} mdk_rays;

/* What was hit, an item per ray, packed. Lists that are NULL are not wanted and cost nothing. For
 * a miss: t infinite, numbers MDK_NONE, all else 0. */
typedef struct mdk_hits {
  size_t struct_size;
  float* t;
  uint32_t* triangle;
  uint32_t* source_triangle; /* its number in the mesh that was baked */
  float* uv;                 /* 2: barycentric coordinates of corners 1 and 2 */
  float* position;           /* 3: on the triangle, by its barycentric coordinates */
  float* normal;             /* 3: the triangle's own, of unit length, outward */
  float* smooth_normal;      /* 3: of unit length, interpolated between the vertices */
  float* velocity;           /* 3: of the material point, units a second of the clip, as played */
  float* texcoord;           /* 2: as in glTF; 0 where there are none */
  uint32_t* material;
  float* base_color;  /* 4: linear RGBA, with texture and vertex colours */
  uint32_t* instance; /* of a scene; 0 for a hit of a model */
  int64_t* id;        /* the user's number of the instance; 0 for a model */
} mdk_hits;

/* Packed lists: 12 bytes from ray to ray, all at time 0 of clip 0, played once. */
MDK_API void mdk_rays_init(mdk_rays* rays, size_t count, const float* origins,
                           const float* directions);
/* Nothing wanted yet. */
MDK_API void mdk_hits_init(mdk_hits* hits);

/* The closest hit of each ray at its own time, ties to the lower triangle: the same bits on every
 * machine and number of threads. No ray slips between triangles that share an edge. */
MDK_API mdk_status mdk_cast(mdk_model* model, const mdk_rays* rays, const mdk_hits* hits);

/* 1 for rays that hit anything, else 0. */
MDK_API mdk_status mdk_occluded(mdk_model* model, const mdk_rays* rays, uint8_t* occluded);

/* All hits of each ray, the nearest first, ties by triangle: ray i has room for `per_ray` of them,
 * from item i * per_ray of the lists; `counts[i]` is how many there are, more than `per_ray` where
 * there was no room. Items that are not used are misses. per_ray * count must be below 2^32. */
MDK_API mdk_status mdk_all_hits(mdk_model* model, const mdk_rays* rays, uint32_t per_ray,
                                const mdk_hits* hits, uint32_t* counts);

/* Points, each at its own time; strides as for rays. */
typedef struct mdk_points {
  size_t struct_size;
  size_t count;
  const float* points; /* 3 floats each, finite */
  const float* radii;  /* what lies farther is not found; NULL: infinite */
  const double* times; /* seconds; NULL: 0 */
  size_t point_stride, radius_stride, time_stride;
  uint32_t clip;
  mdk_wrap wrap;
  uint32_t threads;
} mdk_points;
MDK_API void mdk_points_init(mdk_points* points, size_t count, const float* xyz);

/* The closest point of the mesh to each point, ties to the lower triangle; `t` is the distance. */
MDK_API mdk_status mdk_closest_points(mdk_model* model, const mdk_points* points,
                                      const mdk_hits* hits);

/* ---- baking ---------------------------------------------------------------------------------- */

/* An animated mesh in memory. */
typedef struct mdk_mesh {
  size_t struct_size;
  size_t key_count, vertex_count, face_count;
  const float* vertices;   /* key_count * vertex_count * 3, finite, packed */
  const uint32_t* faces;   /* face_count * 3, below vertex_count, counter-clockwise from outside */
  const double* key_times; /* key_count, rising, from any time; NULL: at `fps` */
  double fps;              /* 30 where key_times and this are not given */
  const char* clip_name;   /* NULL: "clip" */
} mdk_mesh;
MDK_API void mdk_mesh_init(mdk_mesh* mesh, size_t key_count, size_t vertex_count, size_t face_count,
                           const float* vertices, const uint32_t* faces);

typedef struct mdk_bake_options {
  size_t struct_size;
  uint32_t clusters; /* exactly so many; 0: as many as pay */
  uint32_t segments; /* stretches of time with boxes of their own; 0: as many as pay */
  double quantize;   /* positions may be so far off, in rest pose diagonals; 0: exact */
  uint32_t threads;  /* 0: all cores */
} mdk_bake_options;
MDK_API void mdk_bake_options_init(mdk_bake_options* options);

/* Splits the motion into clusters and builds structures that hold at every time (GFW06): what
 * `mdprep bake` does. Copies the mesh. `options` may be NULL. The result depends on the mesh and
 * the options alone. Vertices that move alike are joined. Cost: seconds for 10^4 triangles and 100
 * keys. */
MDK_API mdk_status mdk_bake(const mdk_mesh* mesh, const mdk_bake_options* options,
                            mdk_model** model);

#ifdef __cplusplus
}
#endif

#endif
