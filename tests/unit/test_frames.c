/* Frame sequences: each kind of file gives the values that were written, times come from the right place, and wrong files are
 * reported. */
#include "test_events_folder.h"

#include <hdf5.h>
#include <math.h>
#include <png.h>
#include <sys/stat.h>

#include "archive/td_npy.h"
#include "tides/frames.h"
#include "tides/image.h"

enum { WIDTH = 5, HEIGHT = 3, PIXELS = WIDTH * HEIGHT };

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* Grey or colour, 8 or 16 bit; value(i) counts up from `first`. */
static void write_png(const char *path, int colour, int depth, unsigned first, int width) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    int channels = colour ? 3 : 1;
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)width, HEIGHT, depth, colour ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int y = 0; y < HEIGHT; y++) {
        unsigned char row[3 * 2 * 64];
        for (int k = 0; k < width * channels; k++) {
            unsigned value = first + 100u * (unsigned)(y * width * channels + k);
            if (depth == 16) {
                row[2 * k] = (unsigned char)(value >> 8 & 255);
                row[2 * k + 1] = (unsigned char)(value & 255);
            } else {
                row[k] = (unsigned char)(value & 255);
            }
        }
        png_write_row(png, row);
    }
    png_write_end(png, NULL);
    png_destroy_write_struct(&png, &info);
    assert_int_equal(fclose(file), 0);
}

static tides_frames *open_frames(const char *path, const tides_frames_options *options) {
    tides_frames *frames = NULL;
    tides_error error = {TIDES_OK, ""};
    if (tides_frames_open(path, options, &frames, &error) != TIDES_OK) fail_msg("%s", error.text);
    return frames;
}

static void refused(const char *path, const tides_frames_options *options, tides_status status, const char *text) {
    tides_frames *frames = NULL;
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(tides_frames_open(path, options, &frames, &error), status);
    if (!strstr(error.text, text) || strchr(error.text, '\n')) fail_msg("\"%s\" lacks \"%s\"", error.text, text);
    assert_null(frames);
}

static tides_frames_options at_rate(double rate) {
    tides_frames_options options;
    tides_frames_options_defaults(&options);
    options.frames_per_second = rate;
    return options;
}

static void read_into(tides_frames *frames, size_t index, double *Y) {
    tides_error error = {TIDES_OK, ""};
    if (tides_frames_read(frames, index, Y, &error) != TIDES_OK) fail_msg("%s", error.text);
}

static double decoded(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static void png_of_each_kind(void **state) {
    const char *folder_path = ((folder *)*state)->path;
    for (int kind = 0; kind < 8; kind++) {
        int colour = kind & 1, depth = kind & 2 ? 16 : 8, srgb = kind >> 2;
        double most = depth == 16 ? 65535 : 255;
        const unsigned first = depth == 16 ? 30007 : 7; /* fills its type */
        write_png(in_folder(*state, "a.png"), colour, depth, first, WIDTH);
        tides_frames_options options = at_rate(10);
        options.transfer = srgb ? TIDES_TRANSFER_SRGB : TIDES_TRANSFER_LINEAR;
        tides_frames *frames = open_frames(folder_path, &options);
        double Y[PIXELS];
        assert_int_equal(tides_frames_count(frames), 1);
        read_into(frames, 0, Y);
        for (int i = 0; i < PIXELS; i++) {
            double wanted = 0;
            for (int c = 0; c < (colour ? 3 : 1); c++) {
                unsigned stored = first + 100u * (unsigned)(i * (colour ? 3 : 1) + c);
                double v = (depth == 16 ? stored & 65535u : stored & 255u) / most;
                wanted += (colour ? options.luminance[c] : 1.0) * (srgb ? decoded(v) : v);
            }
            assert_true(fabs(Y[i] - wanted) < 1e-6);
        }
        tides_frames_close(frames);
    }
}

/* Beside the folder of pictures: as the Event Camera Dataset and EDS have them. */
static void lists_of_datasets(void **state) {
    char pictures[4096], list[4096];
    snprintf(pictures, sizeof pictures, "%s", in_folder(*state, "images"));
    assert_int_equal(mkdir(pictures, 0700), 0);
    write_png(in_folder(*state, "images/frame_0.png"), 0, 8, 30, WIDTH);
    write_png(in_folder(*state, "images/frame_1.png"), 0, 8, 20, WIDTH);
    static const char *const texts[][2] = {
        {"images.txt", "1.25 images/frame_0.png\n1.5 images/frame_1.png\n"},
        {"images_timestamps.txt", "1250000\n1500000\n"},
    };
    for (int i = 0; i < 2; i++) {
        tides_frames_options options;
        tides_frames_options_defaults(&options);
        snprintf(list, sizeof list, "%s", in_folder(*state, texts[i][0]));
        write_text(list, texts[i][1]);
        tides_frames *frames = open_frames(pictures, &options);
        assert_true(tides_frames_time(frames, 0) == 1.25 && tides_frames_time(frames, 1) == 1.5);
        tides_frames_close(frames);
        remove(list);
    }
    remove(in_folder(*state, "images/frame_0.png"));
    remove(in_folder(*state, "images/frame_1.png"));
    assert_int_equal(remove(pictures), 0);
}

static void natural_order_and_times(void **state) {
    const char *folder_path = ((folder *)*state)->path;
    write_png(in_folder(*state, "f10.png"), 0, 8, 30, WIDTH);
    write_png(in_folder(*state, "f9.png"), 0, 8, 20, WIDTH);
    write_png(in_folder(*state, "f008.png"), 0, 8, 10, WIDTH);
    tides_frames_options options;
    tides_frames_options_defaults(&options);
    refused(folder_path, &options, TIDES_BAD_CONFIG, "have no times");
    write_text(in_folder(*state, "image_timestamps.txt"), "# us\n1000000\n1500000\n2000001\n");
    tides_frames *frames = open_frames(folder_path, &options);
    double Y[PIXELS];
    for (size_t k = 0; k < 3; k++) {
        read_into(frames, k, Y);
        assert_true(fabs(255 * Y[0] - 10.0 * (double)(k + 1)) < 1e-4);
    }
    assert_true(tides_frames_time(frames, 1) == 1.5);
    assert_true(tides_frames_time(frames, 2) == 2.000001);
    assert_true(isnan(tides_frames_time(frames, 3)));
    assert_int_equal(tides_frames_read(frames, 3, Y, NULL), TIDES_BAD_ARGUMENT);
    tides_frames_close(frames);

    write_text(in_folder(*state, "timestamps.txt"), "0.5 f008.png\n0.75 f9.png\n2.5 f10.png"); /* seconds, and first choice */
    options.rebase = 1;
    frames = open_frames(folder_path, &options);
    assert_true(tides_frames_time(frames, 0) == 0);
    assert_true(tides_frames_time(frames, 2) == 2);
    tides_frames_close(frames);

    write_text(in_folder(*state, "own.txt"), "frame_a.png 0\nframe_b.png 1\nframe_c.png 2\n");
    options.timestamps = in_folder(*state, "own.txt");
    refused(folder_path, &options, TIDES_BAD_FILE, "its times count frames, 0, 1 ...: frames.frames_per_second");
    options.unit = TIDES_TIME_S;
    tides_frames_close(open_frames(folder_path, &options));
    options.unit = TIDES_TIME_AUTO;
    write_text(in_folder(*state, "own.txt"), "1\n2\n");
    options.timestamps = in_folder(*state, "own.txt");
    refused(folder_path, &options, TIDES_BAD_FILE, "has 2 times");
    write_text(in_folder(*state, "own.txt"), "1\n3\n3\n");
    refused(folder_path, &options, TIDES_BAD_FILE, "frame 2 is at 3 s");
    write_text(in_folder(*state, "own.txt"), "1\n2\nx\n");
    refused(folder_path, &options, TIDES_BAD_FILE, "own.txt:3");
    options = at_rate(4);
    frames = open_frames(folder_path, &options);
    assert_true(tides_frames_time(frames, 2) == 0.5);
    tides_frames_close(frames);
}

static void exr_channels(void **state) {
    const char *folder_path = ((folder *)*state)->path;
    float r[PIXELS], g[PIXELS], b[PIXELS];
    for (int i = 0; i < PIXELS; i++) {
        r[i] = (float)i;
        g[i] = 2.5f;
        b[i] = 100.0f * (float)i;
    }
    const tides_channel rgb[] = {{"R", r}, {"G", g}, {"B", b}}, y[] = {{"L", g}, {"Y", b}}, other[] = {{"Z", g}, {"R", r}};
    tides_frames_options options = at_rate(10);
    options.full_scale = 1; /* as bright as that is asked about */
    const char *path = in_folder(*state, "a.exr");
    double Y[PIXELS];
    assert_int_equal(tides_exr_write(path, WIDTH, HEIGHT, rgb, 3, TIDES_EXR_ZIP, NULL, NULL), TIDES_OK);
    tides_frames *frames = open_frames(folder_path, &options);
    read_into(frames, 0, Y);
    for (int i = 0; i < PIXELS; i++) assert_true(fabs(Y[i] - (0.2126 * i + 0.7152 * 2.5 + 0.0722 * 100 * i)) < 1e-4);
    tides_frames_close(frames);
    assert_int_equal(tides_exr_write(path, WIDTH, HEIGHT, y, 2, TIDES_EXR_ZIP, NULL, NULL), TIDES_OK);
    frames = open_frames(folder_path, &options);
    read_into(frames, 0, Y);
    assert_true(Y[3] == 300.0);
    tides_frames_close(frames);
    assert_int_equal(tides_exr_write(path, WIDTH, HEIGHT, other, 2, TIDES_EXR_ZIP, NULL, NULL), TIDES_OK);
    refused(folder_path, &options, TIDES_BAD_FILE, "neither a channel Y nor R, G and B");
}

static void write_npz(const char *path, int zipped, const double *Y, const double *t) {
    const size_t inner[2] = {HEIGHT, WIDTH};
    td_npy_writer *writer = NULL;
    assert_int_equal(td_npy_writer_open(path, zipped, &writer, NULL), TIDES_OK);
    assert_int_equal(td_npy_writer_begin(writer, &(td_npy_form){"Y", "'<f8'", 8, 3, inner}, NULL), TIDES_OK);
    assert_int_equal(td_npy_writer_append(writer, Y, 2, NULL), TIDES_OK);
    if (zipped) {
        assert_int_equal(td_npy_writer_begin(writer, &(td_npy_form){"t", "'<f8'", 8, 1, NULL}, NULL), TIDES_OK);
        assert_int_equal(td_npy_writer_append(writer, t, 2, NULL), TIDES_OK);
    }
    assert_int_equal(td_npy_writer_close(writer, NULL), TIDES_OK);
}

static void write_hdf5(const char *path, const double *Y, const double *t) {
    const hsize_t shape[3] = {2, HEIGHT, WIDTH};
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    hid_t space = H5Screate_simple(3, shape, NULL), line = H5Screate_simple(1, shape, NULL);
    hid_t data = H5Dcreate2(file, "Y", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    hid_t times = H5Dcreate2(file, "t", H5T_IEEE_F64LE, line, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, Y) >= 0);
    assert_true(H5Dwrite(times, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, t) >= 0);
    H5Dclose(times);
    H5Dclose(data);
    H5Sclose(line);
    H5Sclose(space);
    H5Fclose(file);
}

static void arrays_and_memory(void **state) {
    double Y[2 * PIXELS], t[2] = {0.25, 0.75}, read[PIXELS];
    for (int i = 0; i < 2 * PIXELS; i++) Y[i] = 0.1 + i / 3.0;
    char paths[3][640];
    snprintf(paths[0], sizeof paths[0], "%s", in_folder(*state, "a.npz"));
    snprintf(paths[1], sizeof paths[1], "%s", in_folder(*state, "a.npy"));
    snprintf(paths[2], sizeof paths[2], "%s", in_folder(*state, "a.h5"));
    write_npz(paths[0], 1, Y, t);
    write_npz(paths[1], 0, Y, t);
    write_hdf5(paths[2], Y, t);
    for (int kind = 0; kind < 4; kind++) {
        tides_frames_options options = at_rate(kind == 1 ? 2 : 0);
        tides_frames *frames = NULL;
        if (kind < 3)
            frames = open_frames(paths[kind], &options);
        else
            assert_int_equal(tides_frames_from_memory(Y, t, 2, WIDTH, HEIGHT, &frames, NULL), TIDES_OK);
        int32_t width, height;
        tides_frames_size(frames, &width, &height);
        assert_true(width == WIDTH);
        assert_true(height == HEIGHT);
        assert_true(tides_frames_count(frames) == 2);
        assert_true(tides_frames_time(frames, 1) == (kind == 1 ? 0.5 : 0.75));
        read_into(frames, 1, read);
        assert_memory_equal(read, Y + PIXELS, sizeof read);
        tides_frames_close(frames);
    }
    tides_frames_options options = at_rate(0);
    refused(paths[1], &options, TIDES_BAD_CONFIG, "have no times");
    Y[PIXELS + 7] = -1;
    write_npz(paths[0], 1, Y, t);
    tides_frames *frames = open_frames(paths[0], &options);
    tides_error error;
    assert_int_equal(tides_frames_read(frames, 1, read, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "frame 1: pixel (2, 1)"));
    tides_frames_close(frames);
}

/* A dataset that claims what its file can't hold. */
static void claims_are_checked(void **state) {
    const hsize_t shape[3] = {(hsize_t)1 << 40, 4000, 4000}, chunk[3] = {1, 64, 64};
    const char *path = in_folder(*state, "big.h5");
    hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), list = H5Pcreate(H5P_DATASET_CREATE);
    hid_t space = H5Screate_simple(3, shape, NULL);
    H5Pset_chunk(list, 3, chunk);
    hid_t data = H5Dcreate2(file, "frames", H5T_STD_U8LE, space, H5P_DEFAULT, list, H5P_DEFAULT);
    assert_true(data >= 0);
    H5Dclose(data);
    H5Pclose(list);
    H5Sclose(space);
    H5Fclose(file);
    tides_frames_options options = at_rate(10);
    refused(path, &options, TIDES_BAD_FILE, "more than its bytes can hold");
}

/* An array whose elements have fields isn't one of numbers. */
static void structured_array(void **state) {
    const float fields[2 * PIXELS * 2] = {0};
    const size_t inner[2] = {HEIGHT, WIDTH};
    const char *path = in_folder(*state, "pairs.npy");
    tides_frames_options options = at_rate(10);
    tides_error error = {TIDES_OK, ""};
    td_npy_writer *writer = NULL;
    double Y[PIXELS];
    assert_int_equal(td_npy_writer_open(path, 0, &writer, &error), TIDES_OK);
    assert_int_equal(td_npy_writer_begin(writer, &(td_npy_form){"data", "[('a', '<f4'), ('b', '<f4')]", 8, 3, inner}, &error),
                     TIDES_OK);
    assert_int_equal(td_npy_writer_append(writer, fields, 2, &error), TIDES_OK);
    assert_int_equal(td_npy_writer_close(writer, &error), TIDES_OK);
    refused(path, &options, TIDES_BAD_FILE, "aren't numbers");
    options.full_scale = 1;
    tides_frames *frames = open_frames(path, &options);
    assert_int_equal(tides_frames_read(frames, 0, Y, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "aren't numbers"));
    tides_frames_close(frames);
}

/* -- which stored value is full scale -------------------------------------------------------------------------------------- */

/* Twenty frames of numbers up to `most` in each kind of file; only one in the middle is as bright. */
enum { MANY = 20, BRIGHTEST = 9 };
static const char *const number_files[] = {"f.npy", "f.npz", "f.h5", "exr"};
enum { NUMBER_FILES = sizeof number_files / sizeof *number_files };

static void fill_frames(double most, int whole, float values[MANY * PIXELS]) {
    for (int i = 0; i < MANY * PIXELS; i++) {
        const double v = i == BRIGHTEST * PIXELS + 4 ? most : most * (double)(i % 23) / 46;
        values[i] = (float)(whole ? floor(v) : v);
    }
}

static void write_array(const char *path, const char *dtype, hid_t type, size_t item, const void *values) {
    if (strstr(path, ".h5")) {
        const hsize_t shape[3] = {MANY, HEIGHT, WIDTH};
        hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), space = H5Screate_simple(3, shape, NULL);
        hid_t data = H5Dcreate2(file, "frames", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        assert_true(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
        H5Dclose(data);
        H5Sclose(space);
        H5Fclose(file);
        return;
    }
    const size_t inner[2] = {HEIGHT, WIDTH};
    td_npy_writer *writer = NULL;
    assert_int_equal(td_npy_writer_open(path, strstr(path, ".npz") != NULL, &writer, NULL), TIDES_OK);
    assert_int_equal(td_npy_writer_put(writer, &(td_npy_form){"frames", dtype, item, 3, inner}, values, MANY, NULL), TIDES_OK);
    assert_int_equal(td_npy_writer_close(writer, NULL), TIDES_OK);
}

static const char *write_floats(void **state, int kind, double most, int whole) {
    static char path[640];
    float values[MANY * PIXELS];
    fill_frames(most, whole, values);
    snprintf(path, sizeof path, "%s", kind < 3 ? in_folder(*state, number_files[kind]) : ((folder *)*state)->path);
    if (kind < 3) {
        write_array(path, "'<f4'", H5T_NATIVE_FLOAT, sizeof *values, values);
        return path;
    }
    for (int k = 0; k < MANY; k++) {
        char name[32];
        snprintf(name, sizeof name, "f%02d.exr", k);
        const tides_channel one[] = {{"Y", values + k * PIXELS}};
        assert_int_equal(tides_exr_write(in_folder(*state, name), WIDTH, HEIGHT, one, 1, TIDES_EXR_ZIP, NULL, NULL), TIDES_OK);
    }
    return path;
}

static void brightest_is(tides_frames *frames, double wanted) {
    double Y[PIXELS];
    read_into(frames, BRIGHTEST, Y);
    assert_true(fabs(Y[4] - wanted) < 1e-6 * wanted);
}

/* Floats are taken as they are where that can be, as 8 bits where nothing else can be and as that is said; else not at all. */
static void floats_say_their_scale(void **state) {
    for (int kind = 0; kind < NUMBER_FILES; kind++) {
        tides_frames_options options = at_rate(10);
        const struct {
            double most, full;
            int whole;
            const char *note;
        } taken[] = {{1, 1, 0, ""}, {1, 1, 1, ""}, {3.5, 1, 0, "is taken to be 1"}, {200, 255, 1, "taken to be 255"}};
        for (size_t i = 0; i < sizeof taken / sizeof *taken; i++) {
            tides_frames *frames = open_frames(write_floats(state, kind, taken[i].most, taken[i].whole), &options);
            brightest_is(frames, taken[i].most / taken[i].full);
            const char *note = tides_frames_note(frames);
            assert_true(*taken[i].note ? strstr(note, taken[i].note) != NULL : !*note);
            tides_frames_close(frames);
        }
        refused(write_floats(state, kind, 254.5, 0), &options, TIDES_BAD_CONFIG, "frames.full_scale");
        refused(write_floats(state, kind, 4095, 1), &options, TIDES_BAD_CONFIG, "frames.full_scale");
        refused(write_floats(state, kind, 9, 1), &options, TIDES_BAD_CONFIG, "frames.full_scale");
        options.full_scale = 254.5;
        tides_frames *frames = open_frames(write_floats(state, kind, 254.5, 0), &options);
        brightest_is(frames, 1);
        assert_string_equal(tides_frames_note(frames), "");
        tides_frames_close(frames);
    }
}

/* A frame that none of those looked at was like. */
static void a_late_frame_contradicts(void **state) {
    float values[MANY * PIXELS] = {0};
    values[PIXELS] = 90; /* frame 1: not among eight of twenty */
    const char *path = in_folder(*state, "f.npy");
    write_array(path, "'<f4'", H5T_NATIVE_FLOAT, sizeof *values, values);
    tides_frames_options options = at_rate(10);
    tides_frames *frames = open_frames(path, &options);
    double Y[PIXELS];
    tides_error error;
    assert_int_equal(tides_frames_read(frames, 1, Y, &error), TIDES_BAD_CONFIG);
    assert_non_null(strstr(error.text, "frame 1 has a value of 90"));
    assert_int_equal(tides_frames_read(frames, 2, Y, &error), TIDES_OK);
    tides_frames_close(frames);
}

/* Ten and twelve bits in sixteen, and eight in the integers that numpy makes of lists. */
static void integers_fill_their_type(void **state) {
    for (int kind = 0; kind < 3; kind++) {
        uint16_t two[MANY * PIXELS] = {0};
        int64_t eight[MANY * PIXELS] = {0};
        tides_frames_options options = at_rate(10);
        char path[640];
        snprintf(path, sizeof path, "%s", in_folder(*state, number_files[kind]));
        for (unsigned bits = 10; bits <= 14; bits += 2) {
            two[0] = 1; /* the first frame is looked at */
            two[BRIGHTEST * PIXELS + 4] = (uint16_t)((1U << bits) - 1);
            options.full_scale = 0;
            write_array(path, "'<u2'", H5T_NATIVE_UINT16, 2, two);
            refused(path, &options, TIDES_BAD_CONFIG, "of 65535");
            options.full_scale = (double)((1U << bits) - 1);
            tides_frames *frames = open_frames(path, &options);
            brightest_is(frames, 1);
            tides_frames_close(frames);
        }
        two[0] = 40000;
        write_array(path, "'<u2'", H5T_NATIVE_UINT16, 2, two);
        options.full_scale = 0;
        tides_frames_close(open_frames(path, &options));
        eight[0] = 255;
        write_array(path, "'<i8'", H5T_NATIVE_INT64, 8, eight);
        refused(path, &options, TIDES_BAD_CONFIG, "frames.full_scale");
    }
    write_png(in_folder(*state, "a.png"), 0, 16, 7, WIDTH);
    tides_frames_options options = at_rate(10);
    const char *folder_path = ((folder *)*state)->path;
    refused(folder_path, &options, TIDES_BAD_CONFIG, "of 65535");
    options.full_scale = 4095;
    tides_frames *frames = open_frames(folder_path, &options);
    double Y[PIXELS];
    read_into(frames, 0, Y);
    assert_true(fabs(Y[3] - 307.0 / 4095) < 1e-6);
    tides_frames_close(frames);
}

static void wrong_files(void **state) {
    const char *folder_path = ((folder *)*state)->path;
    tides_frames_options options = at_rate(10);
    refused(folder_path, &options, TIDES_BAD_FILE, "no .png or .exr");
    refused(in_folder(*state, "none"), &options, TIDES_FILE_NOT_FOUND, "no such file");
    write_text(in_folder(*state, "a.txt"), "x");
    refused(in_folder(*state, "a.txt"), &options, TIDES_BAD_FILE, "frames come from");
    write_text(in_folder(*state, "a.h5"), "x");
    refused(in_folder(*state, "a.h5"), &options, TIDES_BAD_FILE, "isn't an HDF5 file");
    write_png(in_folder(*state, "a.png"), 1, 8, 1, WIDTH);
    write_png(in_folder(*state, "b.png"), 1, 8, 1, WIDTH + 1);
    tides_frames *frames = open_frames(folder_path, &options);
    double Y[2 * PIXELS];
    tides_error error;
    assert_int_equal(tides_frames_read(frames, 1, Y, &error), TIDES_BAD_FILE);
    assert_non_null(strstr(error.text, "but the first frame is 5 x 3"));
    tides_frames_close(frames);
    assert_int_equal(truncate(in_folder(*state, "a.png"), 60), 0);
    refused(folder_path, &options, TIDES_BAD_FILE, "can't be read");
    write_text(in_folder(*state, "c.exr"), "x");
    refused(folder_path, &options, TIDES_BAD_FILE, "holds .png and .exr");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(png_of_each_kind, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(natural_order_and_times, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(lists_of_datasets, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(exr_channels, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(arrays_and_memory, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(claims_are_checked, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(structured_array, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(floats_say_their_scale, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(a_late_frame_contradicts, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(integers_fill_their_type, folder_setup, folder_teardown),
        cmocka_unit_test_setup_teardown(wrong_files, folder_setup, folder_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
