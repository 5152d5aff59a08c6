/* The library as a C99 program has it: bakes a square that moves, saves and loads it, and asks
 * about it. Prints the first thing that is not as it must be. */
#include <math.h>
#include <mdk/mdk.h>
#include <stdio.h>
#include <string.h>

#define MUST(condition)                                                                   \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      printf("line %d: %s does not hold (%s)\n", __LINE__, #condition, mdk_last_error()); \
      return 1;                                                                           \
    }                                                                                     \
  } while (0)

static int near(float a, float b) { return fabsf(a - b) < 1e-5f; }

int main(int argc, char** argv) {
  /* Along x by 2 in one second, twice. */
  float vertices[3][4][3];
  const uint32_t faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
  const double times[3] = {10, 11, 12};
  const float corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mdk_mesh mesh;
  mdk_model *baked = NULL, *model = NULL;
  mdk_model_info info;
  mdk_clip_info clip;
  mdk_rays rays;
  mdk_hits hits;
  mdk_points points;
  const float origins[2][3] = {{0.5f, 0.25f, 5}, {1.5f, 0.25f, 5}};
  const float down[3] = {0, 0, -1};
  const double ray_times[2] = {0, 0.5};
  float t[2], uv[2][2], velocity[2][3], normal[2][3], position[2][3], xyz[4][3];
  uint32_t triangle[2], source[2], counts[2], instance[2], number;
  uint8_t occluded[2];
  int k, v;
  if (argc != 2) return 2;
  for (k = 0; k < 3; ++k)
    for (v = 0; v < 4; ++v) {
      vertices[k][v][0] = corner[v][0] + 2 * (float)k;
      vertices[k][v][1] = corner[v][1];
      vertices[k][v][2] = 0;
    }
  mdk_mesh_init(&mesh, 3, 4, 2, &vertices[0][0][0], &faces[0][0]);
  mesh.key_times = times;
  mesh.clip_name = "slide";
  MUST(mdk_bake(&mesh, NULL, &baked) == MDK_OK);
  MUST(mdk_model_save(baked, argv[1]) == MDK_OK);
  MUST(mdk_model_load(argv[1], &model) == MDK_OK);
  mdk_model_release(baked);

  mdk_model_info_init(&info);
  MUST(mdk_model_get_info(model, &info) == MDK_OK);
  MUST(info.vertex_count == 4 && info.triangle_count == 2 && info.key_count == 3);
  MUST(near(info.bounds_low[0], 0) && near(info.bounds_high[0], 5));
  mdk_clip_info_init(&clip);
  MUST(mdk_model_get_clip(model, 0, &clip) == MDK_OK);
  MUST(strcmp(clip.name, "slide") == 0 && clip.seconds == 2 && clip.key_count == 3);
  MUST(mdk_model_find_clip(model, "slide", &number) == MDK_OK && number == 0);
  MUST(mdk_model_get_vertices(model, 0, 0.5, MDK_WRAP_ONCE, &xyz[0][0]) == MDK_OK);
  for (k = 0, v = 0; v < 4; ++v) k += near(xyz[v][0], 1) || near(xyz[v][0], 2);
  MUST(k == 4);

  mdk_rays_init(&rays, 2, &origins[0][0], down);
  rays.direction_stride = 0;
  rays.times = ray_times;
  rays.wrap = MDK_WRAP_PING_PONG;
  mdk_hits_init(&hits);
  hits.t = t;
  hits.triangle = triangle;
  hits.source_triangle = source;
  hits.uv = &uv[0][0];
  hits.velocity = &velocity[0][0];
  hits.normal = &normal[0][0];
  hits.position = &position[0][0];
  hits.instance = instance;
  MUST(mdk_cast(model, &rays, &hits) == MDK_OK);
  for (k = 0; k < 2; ++k) {
    MUST(near(t[k], 5) && triangle[k] < 2 && source[k] == 0 && instance[k] == 0);
    MUST(near(velocity[k][0], 2) && near(normal[k][2], 1));
    MUST(near(position[k][0], origins[k][0]) && near(position[k][1], 0.25f));
  }
  /* Backwards from 2 s on, exactly at a key, too. */
  {
    const double back[2] = {4, 3};
    const float at_key[2][3] = {{0.5f, 0.25f, 5}, {2.5f, 0.25f, 5}};
    mdk_rays_init(&rays, 2, &at_key[0][0], down);
    rays.direction_stride = 0;
    rays.times = back;
    rays.wrap = MDK_WRAP_PING_PONG;
    MUST(mdk_cast(model, &rays, &hits) == MDK_OK);
    MUST(near(velocity[0][0], 2) && near(velocity[1][0], -2));
  }
  MUST(mdk_occluded(model, &rays, occluded) == MDK_OK && occluded[0] == 1);
  MUST(mdk_all_hits(model, &rays, 1, &hits, counts) == MDK_OK && counts[0] == 1);
  mdk_points_init(&points, 1, &origins[0][0]);
  MUST(mdk_closest_points(model, &points, &hits) == MDK_OK && near(t[0], 5));

  /* Calls that cannot be: an error that names the argument, and nothing is written. */
  t[0] = 77;
  MUST(mdk_model_load("/nowhere.mdk", &baked) == MDK_ERROR_IO && strlen(mdk_last_error()) > 0);
  MUST(mdk_model_load(NULL, &baked) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "path"));
  MUST(mdk_cast(NULL, &rays, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "model"));
  MUST(mdk_cast(model, NULL, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "rays"));
  MUST(mdk_cast(model, &rays, NULL) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "hits"));
  {
    const double late[2] = {0, NAN};
    const float no_number[2] = {1, NAN};
    mdk_rays bad;
    mdk_hits empty;
    memset(&bad, 0, sizeof bad);
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE &&
         strstr(mdk_last_error(), "struct_size"));
    bad = rays;
    bad.times = late;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE &&
         strstr(mdk_last_error(), "times: number 1"));
    bad = rays;
    bad.t_max = no_number;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE &&
         strstr(mdk_last_error(), "t_max: number 1"));
    bad = rays;
    bad.clip = 7;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "clip 7"));
    bad = rays;
    bad.wrap = 9;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "wrap"));
    bad = rays;
    bad.origins = NULL;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "origins"));
    bad.count = 0;
    MUST(mdk_cast(model, &bad, &hits) == MDK_OK);
    mdk_hits_init(&empty);
    MUST(mdk_cast(model, &rays, &empty) == MDK_OK);
#if SIZE_MAX > 0xFFFFFFFFu
    bad = rays;
    bad.count = (size_t)1 << 32;
    MUST(mdk_cast(model, &bad, &hits) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "2^32"));
#endif
  }
  MUST(mdk_model_get_clip(model, 5, &clip) == MDK_ERROR_USAGE);
  MUST(mdk_model_find_clip(model, "run", &number) == MDK_ERROR_USAGE &&
       strstr(mdk_last_error(), "slide"));
  MUST(mdk_model_get_vertices(model, 0, NAN, MDK_WRAP_ONCE, &xyz[0][0]) == MDK_ERROR_USAGE);
  vertices[1][2][0] = NAN;
  MUST(mdk_bake(&mesh, NULL, &baked) == MDK_ERROR_BAD_INPUT &&
       strstr(mdk_last_error(), "vertex 2 of key 1"));
  mesh.fps = 0;
  mesh.key_times = NULL;
  MUST(mdk_bake(&mesh, NULL, &baked) == MDK_ERROR_USAGE && strstr(mdk_last_error(), "fps"));
  mesh.face_count = 0;
  MUST(mdk_bake(&mesh, NULL, &baked) == MDK_ERROR_BAD_INPUT && strstr(mdk_last_error(), "faces"));
  MUST(t[0] == 77);
  mdk_model_release(model);
  mdk_model_release(NULL);
  printf("all is as it must be\n");
  return 0;
}
