/* Any bytes as a PLY scene: parsed into Gaussians that can be checked, or refused in one line with the output untouched.
 * For libFuzzer (clang -fsanitize=fuzzer,address). Built with -DTIDES_FUZZ_MAIN it is a program of its own, for machines
 * without libFuzzer: `fuzz_ply [SECONDS [SEED]]` mutates small valid scenes; `fuzz_ply FILE ...` replays files. */
#include "fuzz.h"

#include "scene/td_scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    float untouched = 0;
    td_gaussians gaussians = {.count = -1, .sh_degree = -1, .mean = &untouched, .sh = &untouched};
    tides_error error = {0, ""};
    tides_status status = td_ply_parse("fuzz", data, size, &gaussians, &error);
    if (status != TIDES_OK) {
        fuzz_refusal(status, &error);
        if (gaussians.count != -1 || gaussians.mean != &untouched || gaussians.sh != &untouched) abort();
        return 0;
    }
    /* Every Gaussian takes at least 14 bytes of the file: memory is bounded by what was read. */
    if (gaussians.count < 1 || (uint64_t)gaussians.count > size / 14) abort();
    status = td_gaussians_check(&gaussians, 1, TIDES_BAD_FILE, &error);
    if (status != TIDES_OK) fuzz_refusal(status, &error);
    td_gaussians_free(&gaussians);
    return 0;
}

#ifdef TIDES_FUZZ_MAIN
#include "td_base.h"

#include <stdio.h>

enum { SEED_FILES = 6, SEED_BYTES = 4096, MUTANT_BYTES = 2 * SEED_BYTES };

typedef struct sample {
    unsigned char bytes[SEED_BYTES];
    size_t size;
} sample;

/* splitmix64 (Steele, Lea, Flood 2014) */
static uint64_t next(uint64_t *seed) {
    uint64_t x = *seed += UINT64_C(0x9e3779b97f4a7c15);
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

static void add(sample *s, const char *text) {
    size_t length = strlen(text);
    if (s->size + length > SEED_BYTES) abort();
    memcpy(s->bytes + s->size, text, length);
    s->size += length;
}

/* Two Gaussians of degree 0 or 1 in each format, with a list before them. Binary rows are all 1: 0x3f800000 in either order. */
static void make_sample(sample *s, int number) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    static const char *const names[] = {"x",       "y",       "z",     "f_dc_0", "f_dc_1", "f_dc_2",    "opacity", "scale_0",
                                        "scale_1", "scale_2", "rot_0", "rot_1",  "rot_2",  "filter_3D", "rot_3"};
    static const unsigned char ones[2][4] = {{0, 0, 0x80, 0x3f}, {0x3f, 0x80, 0, 0}};
    int format = number % 3, rest = number / 3 * 9, binary = format > 0;
    char line[64];
    s->size = 0;
    snprintf(line, sizeof line, "ply\nformat %s 1.0\ncomment c\n", formats[format]);
    add(s, line);
    add(s, "element face 2\nproperty list uchar char vertex_indices\nelement vertex 2\n");
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(line, sizeof line, "property float %s\n", names[i]);
        add(s, line);
    }
    for (int i = 0; i < rest; i++) {
        snprintf(line, sizeof line, "property float f_rest_%d\n", i);
        add(s, line);
    }
    add(s, "end_header\n");
    add(s, binary ? "\x02\x01\x02\x01\x01" : "2 1 2\n1 1\n");
    for (int i = 0; i < 2 * (15 + rest); i++) {
        if (!binary) {
            add(s, (i + 1) % (15 + rest) ? "1.5 " : "-2e-3\n");
            continue;
        }
        memcpy(s->bytes + s->size, ones[format - 1], 4);
        s->size += 4;
    }
}

/* Replaces, removes, doubles or inserts a few bytes, or cuts the end off. */
static size_t mutate(unsigned char *bytes, size_t size, uint64_t *seed) {
    static const char *const tokens[] = {"-1",  "0", "99999999999999999999", "4294967295", "list ", "double", "\n", "\r\n",
                                         "nan", " "};
    for (uint64_t edits = 1 + next(seed) % 4; edits > 0 && size > 0; edits--) {
        size_t at = (size_t)(next(seed) % size), length = 1 + (size_t)(next(seed) % 16);
        if (length > size - at) length = size - at;
        const char *token = tokens[next(seed) % (sizeof tokens / sizeof tokens[0])];
        const void *inserted = next(seed) % 2 ? (const void *)token : NULL;
        size_t grown = inserted ? strlen(token) : length;
        switch (next(seed) % 5) {
            case 0: bytes[at] = (unsigned char)next(seed); break;
            case 1: bytes[at] ^= (unsigned char)(1u << next(seed) % 8); break;
            case 2: size = next(seed) % 4 ? size : at; break;
            case 3:
                memmove(bytes + at, bytes + at + length, size - at - length);
                size -= length;
                break;
            default:
                if (size + grown > MUTANT_BYTES) break;
                memmove(bytes + at + grown, bytes + at, size - at);
                if (inserted) memcpy(bytes + at, inserted, grown); /* else the bytes are doubled */
                size += grown;
                break;
        }
    }
    return size;
}

/* Each mutant is parsed from a block of exactly its size, so that a sanitiser sees every byte read beyond it. */
static void run_mutants(double seconds, uint64_t seed) {
    static sample samples[SEED_FILES];
    static unsigned char bytes[MUTANT_BYTES];
    for (int i = 0; i < SEED_FILES; i++) make_sample(&samples[i], i);
    for (int i = 0; i < SEED_FILES; i++) {
        td_gaussians g; /* the seeds themselves must be valid, or nothing deep is reached */
        if (td_ply_parse("seed", samples[i].bytes, samples[i].size, &g, NULL) != TIDES_OK) abort();
        td_gaussians_free(&g);
    }
    double end = td_now() + seconds;
    unsigned long runs = 0;
    for (; runs < 2000 || td_now() < end; runs++) {
        const sample *chosen = &samples[next(&seed) % SEED_FILES];
        memcpy(bytes, chosen->bytes, chosen->size);
        size_t size = mutate(bytes, chosen->size, &seed);
        unsigned char *exact = malloc(size ? size : 1);
        if (!exact) abort();
        memcpy(exact, bytes, size);
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    printf("%lu mutants\n", runs);
}

static int replay(const char *path) {
    char *data = NULL;
    size_t size = 0;
    tides_error error = {0, ""};
    if (td_read_file(path, SIZE_MAX - 1, &data, &size, &error)) {
        fprintf(stderr, "%s\n", error.text);
        return 1;
    }
    LLVMFuzzerTestOneInput((const uint8_t *)data, size);
    free(data);
    printf("%s: survived\n", path);
    return 0;
}

int main(int argc, char **argv) {
    char *end = NULL;
    double seconds = argc > 1 ? strtod(argv[1], &end) : 1;
    if (argc > 1 && (*end || end == argv[1])) {
        int failed = 0;
        for (int i = 1; i < argc; i++) failed |= replay(argv[i]);
        return failed;
    }
    uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    printf("seed %llu\n", (unsigned long long)seed);
    run_mutants(seconds, seed);
    return 0;
}
#endif
