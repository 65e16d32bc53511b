// A C++17 program that counts a scene's Gaussians.
#include <iostream>
#include <memory>
#include <tides.h>

struct destroy {
    void operator()(tides_scene *scene) const { tides_scene_destroy(scene); }
};

int main(int argc, char **argv) {
    tides_error error{};
    tides_scene *made = nullptr;
    if (tides_scene_create(&made, &error) != TIDES_OK) return 1;
    const std::unique_ptr<tides_scene, destroy> scene{made};
    if (tides_scene_add_file(scene.get(), argv[argc - 1], nullptr, 1.0, &error) != TIDES_OK) {
        std::cerr << error.text << '\n';
        return 1;
    }
    std::cout << "TIDES " << tides_version() << " from C++17: " << tides_scene_count(scene.get()) << " Gaussians\n";
}
