// Renders a built-in hairstyle into a PPM picture, by pelage.hpp.
//
//     c++ -std=c++17 examples/cpp/offscreen.cpp -Iinclude -Ltarget/release -lpelage -o offscreen
//     ./offscreen [picture.ppm [strands]]

#include <cmath>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>

#include "pelage.hpp"

namespace {

constexpr uint32_t WIDTH = 480, HEIGHT = 640;

// A linear value as a byte of the sRGB curve.
char srgb(float value) {
    const double v = value < 0.0f ? 0.0 : value > 1.0f ? 1.0 : static_cast<double>(value);
    const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
    return static_cast<char>(static_cast<unsigned char>(255.0 * encoded + 0.5));
}

// Premultiplied hair over a grey wall.
void write_ppm(const std::string &path, const std::vector<float> &pixels) {
    std::ofstream file(path, std::ios::binary);
    file << "P6\n" << WIDTH << ' ' << HEIGHT << "\n255\n";
    for (std::size_t at = 0; at < pixels.size(); at += 4) {
        for (std::size_t channel = 0; channel < 3; channel++) {
            file.put(srgb(pixels[at + channel] + (1.0f - pixels[at + 3]) * 0.18f));
        }
    }
    if (!file.flush()) {
        throw std::runtime_error(path + " cannot be written");
    }
}

void run(const std::string &path, uint64_t strands) {
    const pelage::Context context = pelage::Context::offscreen();
    std::cout << "pelage " << pelage_version() << " on " << context.adapter().name << '\n';
    const pelage::Hair hair = context.builtin(PELAGE_BUILTIN_WAVY, strands);

    PelageTargetDescriptor image = PELAGE_TARGET_DESCRIPTOR_INIT;
    image.width = WIDTH;
    image.height = HEIGHT;
    const pelage::Target target = context.target(image);

    // The head's origin lies between the ears; it looks along +z, in metres.
    const double eye[] = {0.6, 0.15, -0.75}, middle[] = {0.0, -0.06, 0.0}, up[] = {0.0, 1.0, 0.0};
    const PelageView view = pelage::perspective(eye, middle, up, 0.5, double(WIDTH) / HEIGHT, 0.1, 10.0);

    PelageLight sun = PELAGE_LIGHT_INIT;
    sun.direction[0] = -0.9;
    sun.direction[1] = -0.8;
    sun.direction[2] = 0.2;
    sun.power[0] = sun.power[1] = sun.power[2] = 3.0f;

    const PelageHair drawn = hair.get();
    PelageFrame frame = PELAGE_FRAME_INIT;
    frame.hairs = &drawn;
    frame.hair_count = 1;
    frame.lights = &sun;
    frame.light_count = 1;
    frame.ambient[0] = frame.ambient[1] = frame.ambient[2] = 0.05f;
    frame.view = &view;
    context.render(frame, target);
    write_ppm(path, target.read_colour());
    std::cout << context.statistics().strands << " strands; wrote " << path << '\n';
}

} // namespace

int main(int argc, char **argv) {
    try {
        run(argc > 1 ? argv[1] : "offscreen.ppm",
            argc > 2 ? std::strtoull(argv[2], nullptr, 10) : PELAGE_BUILTIN_STRAND_COUNT);
    } catch (const std::exception &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
