/* Recognises a file of a wrong kind by its first bytes or its ending, and says what to do with it. There is one piece of
 * advice for each family of kinds and each purpose: a scene, events, poses, frames or a run file was wanted. */
#include "td_kinds.h"

#include "td_folder.h"

#include <stdlib.h>
#include <string.h>

enum family {
    VIDEO,
    PICTURE,
    FRAMES,
    BAG_1,
    BAG_2,
    ARCHIVE,
    COMPRESSED,
    USD,
    MESH,
    POINTS,
    SPLATS,
    EVENTS,
    OLD_AEDAT,
    AEDAT_4,
    NUMPY,
    HDF5,
    PICKLE,
    MATLAB,
    TABLE,
    XML,
    UTF16,
    PAGE,
    POINTER,
    DOCUMENT,
    PROGRAM,
    FAMILIES
};

/* -- advice: % stands for the path ---------------------------------------------------------------------------------------- */

static const char pipe[] = "ffmpeg -i % -f yuv4mpegpipe - | tides simulate - -o events.h5 makes events of it";
static const char bag[] = "python -m tides.bag % FOLDER makes a folder of its events, frames and poses (pip install "
                          "tides[rosbags]), which tides info and tides init take";
static const char named_frames[] = "--set frames.file=% makes events of frames";
static const char folder[] = "frames are a folder of .png or .exr pictures: name the folder in frames.file; ffmpeg -i % a.png "
                             "converts a picture";

static const char *const advice[FAMILIES][TD_WANTS] = {
    [VIDEO] = {[TD_WANTS_ANY] = pipe,
               [TD_WANTS_SCENE] = "train splats on its pictures (Brush, gsplat, nerfstudio)",
               [TD_WANTS_POSES] = "COLMAP finds the poses of its pictures"},
    [PICTURE] = {[TD_WANTS_ANY] = folder,
                 [TD_WANTS_SCENE] = "train splats on pictures (Brush, gsplat, nerfstudio)",
                 [TD_WANTS_POSES] = "COLMAP finds the poses of pictures"},
    [FRAMES] = {[TD_WANTS_ANY] = named_frames},
    [BAG_1] = {[TD_WANTS_ANY] = bag},
    [BAG_2] = {[TD_WANTS_ANY] = bag},
    [ARCHIVE] = {[TD_WANTS_ANY] = "unpack it, and name the file or folder within"},
    [COMPRESSED] = {[TD_WANTS_ANY] = "unpack it (gunzip, zstd -d, xz -d), and name what comes out"},
    [USD] = {[TD_WANTS_ANY] = "python -m tides.usd % scene.h5 converts its Gaussians (pip install tides[usd])"},
    [MESH] = {[TD_WANTS_ANY] = "it holds meshes and no Gaussians: train splats on pictures rendered of it (Brush, gsplat)",
              [TD_WANTS_FRAMES] = "render it to a folder of .png or .exr pictures, and name that in frames.file",
              [TD_WANTS_POSES] = "export the camera's path as lines 't x y z qx qy qz qw' (TUM) or a transforms.json"},
    [POINTS] = {[TD_WANTS_ANY] = "points have no shape and no colour to each side: train splats from them (Brush, gsplat)"},
    [SPLATS] = {[TD_WANTS_ANY] = "scene.file takes it; tides info and render show it",
                [TD_WANTS_SCENE] = "splat-transform makes a 3DGS .ply of it"},
    [EVENTS] = {[TD_WANTS_ANY] = "it holds events: tides info, view, cut, export, convert and metrics take it"},
    [AEDAT_4] = {[TD_WANTS_ANY] = "it holds events: tides info, view, cut, export, convert and metrics take it"},
    [OLD_AEDAT] = {[TD_WANTS_ANY] = "AEDAT 2 and 4 are read: export it as one of them, or as text, in DV or jAER"},
    [NUMPY] = {[TD_WANTS_ANY] = "tides info says what is in it; arrays (frames, height, width) go to frames.file",
               [TD_WANTS_RUN] = "--set frames.file=% makes events of frames; what holds events is there already (tides info)",
               [TD_WANTS_SCENE] = "tides.Scene().add takes arrays of Gaussians in Python"},
    [HDF5] = {[TD_WANTS_ANY] = "tides info says what is in it",
              [TD_WANTS_RUN] =
                  "--set scene.file=% or --set frames.file=% names it; what holds events is there already (tides info)"},
    [PICKLE] = {[TD_WANTS_ANY] = "load it in Python and save its arrays: numpy.save, or tides.Scene().add and save"},
    [MATLAB] = {[TD_WANTS_ANY] = "scipy.io.loadmat reads it: save its arrays with numpy.save"},
    [TABLE] = {[TD_WANTS_ANY] = "pandas reads it: write its columns as .csv"},
    [XML] = {[TD_WANTS_ANY] = "another file was meant",
             [TD_WANTS_POSES] = "export the cameras as COLMAP's text, a transforms.json, or lines 't x y z qx qy qz qw' (TUM)"},
    [UTF16] = {[TD_WANTS_ANY] = "save it as UTF-8 (iconv -f UTF-16 -t UTF-8)"},
    [PAGE] = {[TD_WANTS_ANY] = "what was to be downloaded needs another address, or a login"},
    [POINTER] = {[TD_WANTS_ANY] = "git lfs pull fetches the file itself"},
    [DOCUMENT] = {[TD_WANTS_ANY] = "another file was meant"},
    [PROGRAM] = {[TD_WANTS_ANY] = "another file was meant"},
};

static const char *const wishes[TD_WANTS] = {[TD_WANTS_SCENE] = "a scene of splats",
                                             [TD_WANTS_EVENTS] = "an event file",
                                             [TD_WANTS_POSES] = "a camera path",
                                             [TD_WANTS_FRAMES] = "frames",
                                             [TD_WANTS_RUN] = "a run file",
                                             [TD_WANTS_TEXT] = "a text file",
                                             [TD_WANTS_ANY] = "read here"};

/* 1 if a reader takes this family for this purpose: then its own error says more than advice from here. */
static int is_wanted(int family, int wanted) {
    switch (wanted) {
        case TD_WANTS_SCENE: return family == HDF5;
        case TD_WANTS_EVENTS: return family == EVENTS || family == AEDAT_4 || family == HDF5 || family == NUMPY;
        case TD_WANTS_POSES: return family == NUMPY;
        case TD_WANTS_FRAMES: return family == FRAMES || family == AEDAT_4 || family == HDF5 || family == NUMPY;
        case TD_WANTS_ANY:
            return family == HDF5 || family == NUMPY || family == EVENTS || family == AEDAT_4 || family == SPLATS ||
                   family == FRAMES;
        default: return 0;
    }
}

/* -- the kinds: the first row that fits is taken ----------------------------------------------------------------------- */

typedef struct kind {
    const char *magic;  /* NULL: only the ending is compared */
    size_t bytes, at;   /* length of `magic`, and its position in the file */
    const char *ending; /* NULL: any ending */
    const char *name;
    int family;
} kind;

enum { HEAD = 528 }; /* bytes read of a file; HDF5 in MATLAB 7.3's files begins at byte 512 */
#define MAGIC(text) text, sizeof text - 1

static const kind kinds[] = {
    {MAGIC("ftyp"), 4, ".mov", "a QuickTime video", VIDEO},
    {MAGIC("ftypqt"), 4, NULL, "a QuickTime video", VIDEO},
    {MAGIC("ftyphei"), 4, NULL, "a HEIF picture", PICTURE},
    {MAGIC("ftypavif"), 4, NULL, "an AVIF picture", PICTURE},
    {MAGIC("ftyp"), 4, NULL, "an MP4 video", VIDEO},
    {MAGIC("moov"), 4, NULL, "a QuickTime video", VIDEO},
    {MAGIC("\x1a\x45\xdf\xa3"), 0, NULL, "a Matroska or WebM video", VIDEO},
    {MAGIC("AVI "), 8, NULL, "an AVI video", VIDEO},
    {MAGIC("FLV\x01"), 0, NULL, "a Flash video", VIDEO},
    {MAGIC("GIF8"), 0, NULL, "a GIF animation", VIDEO},
    {MAGIC("\x00\x00\x01\xba"), 0, NULL, "an MPEG video", VIDEO},
    {MAGIC("\x47\x40\x00"), 0, ".ts", "an MPEG video", VIDEO},
    {MAGIC("YUV4MPEG2"), 0, NULL, "a YUV4MPEG2 video", FRAMES},
    {MAGIC("\xff\xd8\xff"), 0, NULL, "a JPEG picture", PICTURE},
    {MAGIC("\x89PNG\r\n\x1a\n"), 0, NULL, "a PNG picture", PICTURE},
    {MAGIC("\x76\x2f\x31\x01"), 0, NULL, "an OpenEXR picture", PICTURE},
    {MAGIC("WEBP"), 8, NULL, "a WebP picture", PICTURE},
    {MAGIC("II*\x00"), 0, NULL, "a TIFF picture", PICTURE},
    {MAGIC("MM\x00*"), 0, NULL, "a TIFF picture", PICTURE},
    {MAGIC("#?RADIANCE"), 0, NULL, "a Radiance picture", PICTURE},
    {MAGIC("BM"), 0, ".bmp", "a BMP picture", PICTURE},
    {MAGIC("#ROSBAG V"), 0, NULL, "a ROS 1 bag", BAG_1},
    {MAGIC("\x89MCAP"), 0, NULL, "an MCAP file, as ROS 2 bags are and tides dataset writes them,", BAG_2},
    {MAGIC("SQLite format 3\x00"), 0, ".db3", "a ROS 2 bag", BAG_2},
    {MAGIC("SQLite format 3\x00"), 0, NULL, "an SQLite database", TABLE},
    {MAGIC("PK\x03\x04"), 0, ".usdz", "an OpenUSD archive", USD},
    {MAGIC("PXR-USDC"), 0, NULL, "an OpenUSD scene", USD},
    {MAGIC("#usda"), 0, NULL, "an OpenUSD scene", USD},
    {MAGIC("PK\x03\x04"), 0, ".npz", "a numpy archive", NUMPY},
    {MAGIC("PK\x03\x04"), 0, ".sog", "a SOG scene", SPLATS},
    {MAGIC("PK\x03\x04"), 0, ".pt", "a PyTorch file", PICKLE},
    {MAGIC("PK\x03\x04"), 0, ".pth", "a PyTorch file", PICKLE},
    {MAGIC("PK\x03\x04"), 0, ".ckpt", "a PyTorch checkpoint", PICKLE},
    {MAGIC("PK\x03\x04"), 0, NULL, "a ZIP archive", ARCHIVE},
    {MAGIC("7z\xbc\xaf\x27\x1c"), 0, NULL, "a 7-Zip archive", ARCHIVE},
    {MAGIC("Rar!\x1a\x07"), 0, NULL, "a RAR archive", ARCHIVE},
    {MAGIC("ustar"), 257, NULL, "a tar archive", ARCHIVE},
    {MAGIC("\x1f\x8b"), 0, ".spz", "a .spz scene", SPLATS},
    {MAGIC("\x1f\x8b"), 0, NULL, "a gzip file", COMPRESSED},
    {MAGIC("\x28\xb5\x2f\xfd"), 0, NULL, "a zstd file", COMPRESSED},
    {MAGIC("\xfd"
           "7zXZ"),
     0, NULL, "an xz file", COMPRESSED},
    {MAGIC("BZh"), 0, NULL, "a bzip2 file", COMPRESSED},
    {MAGIC("\x04\x22\x4d\x18"), 0, NULL, "an lz4 file", COMPRESSED},
    {MAGIC("BLENDER"), 0, NULL, "a Blender file", MESH},
    {MAGIC("Kaydara FBX"), 0, NULL, "an FBX file", MESH},
    {MAGIC("; FBX"), 0, NULL, "an FBX file", MESH},
    {NULL, 0, 0, ".obj", "a Wavefront file", MESH},
    {NULL, 0, 0, ".stl", "an STL file", MESH},
    {NULL, 0, 0, ".dae", "a Collada file", MESH},
    {NULL, 0, 0, ".abc", "an Alembic file", MESH},
    {MAGIC("LASF"), 0, NULL, "a LAS point cloud", POINTS},
    {MAGIC("ASTM-E57"), 0, NULL, "an E57 point cloud", POINTS},
    {MAGIC("# .PCD"), 0, NULL, "a PCD point cloud", POINTS},
    {MAGIC("ply\n"), 0, NULL, "a PLY file", SPLATS},
    {MAGIC("ply\r\n"), 0, NULL, "a PLY file", SPLATS},
    {MAGIC("NGSP"), 0, NULL, "a .spz scene", SPLATS},
    {MAGIC("glTF"), 0, NULL, "a glTF scene", SPLATS},
    {NULL, 0, 0, ".splat", "a .splat scene", SPLATS},
    {NULL, 0, 0, ".ksplat", "a .ksplat scene", SPLATS},
    {MAGIC("Kg\0\0"), 0, NULL, "a .splatv scene", SPLATS},
    {NULL, 0, 0, ".lcc", "an LCC scene", SPLATS},
    {NULL, 0, 0, ".lcc2", "an LCC2 scene", SPLATS},
    {MAGIC("#!AER-DAT1"), 0, NULL, "an AEDAT 1 recording", OLD_AEDAT},
    {MAGIC("#!AER-DAT3"), 0, NULL, "an AEDAT 3 recording", OLD_AEDAT},
    {MAGIC("#!AER-DAT4"), 0, NULL, "an AEDAT 4 recording", AEDAT_4},
    {MAGIC("#!AER-DAT"), 0, NULL, "an AEDAT recording", EVENTS},
    {MAGIC("Event Stream"), 0, NULL, "an Event Stream recording", EVENTS},
    {MAGIC("% evt "), 0, NULL, "an EVT recording", EVENTS},
    {MAGIC("% camera_integrator_name"), 0, NULL, "an EVT recording", EVENTS},
    {MAGIC("% Date"), 0, NULL, "a DAT recording", EVENTS},
    {MAGIC("\x93NUMPY"), 0, NULL, "a numpy array", NUMPY},
    {MAGIC("MATLAB 7.3 MAT-file"), 0, NULL, "a MATLAB 7.3 file", MATLAB},
    {MAGIC("MATLAB 5.0 MAT-file"), 0, NULL, "a MATLAB file", MATLAB},
    {MAGIC("\x89HDF\r\n\x1a\n"), 0, NULL, "an HDF5 file", HDF5},
    {MAGIC("\x80\x02"), 0, NULL, "a Python pickle", PICKLE},
    {MAGIC("\x80\x03"), 0, NULL, "a Python pickle", PICKLE},
    {MAGIC("\x80\x04\x95"), 0, NULL, "a Python pickle", PICKLE},
    {MAGIC("\x80\x05\x95"), 0, NULL, "a Python pickle", PICKLE},
    {MAGIC("PAR1"), 0, NULL, "a Parquet table", TABLE},
    {MAGIC("ARROW1"), 0, NULL, "an Arrow table", TABLE},
    {MAGIC("\xff\xfe"), 0, NULL, "text in UTF-16", UTF16}, /* the output of PowerShell's > */
    {MAGIC("\xfe\xff"), 0, NULL, "text in UTF-16", UTF16},
    {MAGIC("<?xml"), 0, NULL, "an XML file", XML},
    {MAGIC("<!DOCTYPE html"), 0, NULL, "a web page", PAGE},
    {MAGIC("<!doctype html"), 0, NULL, "a web page", PAGE},
    {MAGIC("<html"), 0, NULL, "a web page", PAGE},
    {MAGIC("version https://git-lfs"), 0, NULL, "a pointer of Git LFS", POINTER},
    {MAGIC("%PDF-"), 0, NULL, "a PDF document", DOCUMENT},
    {MAGIC("\x7f"
           "ELF"),
     0, NULL, "a program or library", PROGRAM},
    {MAGIC("MZ"), 0, ".exe", "a program", PROGRAM},
};

static const kind *find(const char *path, const char *head, size_t got) {
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const kind *k = &kinds[i];
        if (k->ending && !td_ends_in(path, k->ending)) continue;
        if (!k->magic || (got >= k->at + k->bytes && memcmp(head + k->at, k->magic, k->bytes) == 0)) return k;
    }
    return NULL;
}

/* Copies the advice with each % replaced by the path. */
static void put_path(const char *text, const char *path, char *out, size_t size) {
    size_t used = 0;
    for (; *text && used + 1 < size; text++) {
        const int written = *text == '%' ? snprintf(out + used, size - used, "%.200s", path) : 1;
        if (*text != '%') out[used] = *text;
        used += written < (int)(size - used) ? (size_t)written : size - used - 1;
    }
    out[used] = '\0';
}

/* Reads the first bytes of a file; returns their number, 0 if the file can't be read. */
static size_t read_head(const char *path, char head[HEAD]) {
    FILE *file = td_is_file(path) ? fopen(path, "rb") : NULL;
    const size_t got = file ? fread(head, 1, HEAD, file) : 0;
    if (file) fclose(file);
    return got;
}

/* A folder is recognised as a rosbag2 recording by its metadata.yaml. */
static const kind *find_folder(const char *path) {
    static const kind own = {MAGIC("rosbag2_bagfile_information"), 0, NULL, "the folder of a ROS 2 bag", BAG_2};
    char head[HEAD], *metadata = td_format(NULL, "%s/metadata.yaml", path);
    const size_t got = metadata ? read_head(metadata, head) : 0;
    free(metadata);
    return got >= own.bytes && memcmp(head, own.magic, own.bytes) == 0 ? &own : NULL;
}

tides_status td_kind_refuse(const char *path, int wanted, tides_error *error) {
    char head[HEAD], line[640];
    const int is_folder = td_is_folder(path);
    const size_t got = is_folder ? 0 : read_head(path, head);
    const kind *k = is_folder ? find_folder(path) : got ? find(path, head, got) : NULL;
    if (!k || is_wanted(k->family, wanted)) return TIDES_OK;
    const char *text = advice[k->family][wanted] ? advice[k->family][wanted] : advice[k->family][TD_WANTS_ANY];
    put_path(text, path, line, sizeof line);
    const char *comma = k->name[strlen(k->name) - 1] == ',' ? "" : ",";
    return td_fail(error, TIDES_BAD_FILE, "%s: is %s%s not %s: %s", path, k->name, comma, wishes[wanted], line);
}

tides_status td_kind_judge(const char *path, int wanted, tides_status status, tides_error *error) {
    if (status != TIDES_BAD_FILE && status != TIDES_BAD_CONFIG && status != TIDES_UNSUPPORTED &&
        !(status == TIDES_FILE_NOT_FOUND && td_is_folder(path)))
        return status;
    const tides_status judged = td_kind_refuse(path, wanted, error);
    return judged ? judged : status;
}

tides_status tides_file_foreign(const char *path, tides_error *error) {
    return path ? td_kind_refuse(path, TD_WANTS_ANY, error) : TIDES_OK;
}
