#include <stdio.h>
#include <tides.h>
int main(int argc, char **argv) {
    tides_error error = {0};
    tides_scene *scene = NULL;
    int failed = tides_scene_create(&scene, &error) || tides_scene_add_file(scene, argv[argc - 1], NULL, 1.0, &error);
    if (failed)
        puts(error.text);
    else
        printf("TIDES %s: %s holds %d Gaussians\n", tides_version(), argv[1], (int)tides_scene_count(scene));
    tides_scene_destroy(scene);
    return failed;
}
