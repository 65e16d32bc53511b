/* Reads the records of a .spz (versions 2 to 4), one of which gives the axes of its values.
 *
 * A record (an "extension" of .spz) has its type and the number of its bytes, both uint32, and then the bytes. Adobe's
 * record of type 0xADBE0003 has one uint32: the number of a coordinate system, which gives the directions of x, y and z in
 * positions, rotations and SH. 1 LDB, 2 RDB, 3 LUB, 4 RUB, 5 LDF, 6 RDF, 7 LUF, 8 RUF (left or right, down or up, back or
 * front). 9 LFD, 10 RFD, 11 LFU, 12 RFU, 13 LBD, 14 RBD, 15 LBU, 16 RBU have a quarter turn about x, so that y is front or
 * back and z down or up. 0, or no record: RUB. Where x points left, reading changes the signs of coordinates, but doesn't
 * mirror the scene. */
#include "td_base.h"
#include "td_endian.h"
#include "td_scene.h"
#include "td_splat.h"

/* RECORD: size of a record's type and length [bytes]. SYSTEMS: the greatest number of a coordinate system; systems above
 * UNTURNED have a quarter turn. */
enum { RECORD = 8, RUB = 4, SYSTEMS = 16, UNTURNED = 8 };

/* Types of other known records. A silent record changes nothing that is read, and gets no note: type 0, and Adobe's for the
 * quantisation of SH and for limits of a camera's orbit. place_record is Niantic's georeference of the scene. */
static const uint32_t system_record = 0xadbe0003, silent_records[] = {0, 0xadbe0001, 0xadbe0002}, place_record = 0x4e530001;

static tides_status read_system(const char *path, const unsigned char *payload, uint32_t bytes, td_spz_records *found,
                                tides_error *error) {
    if (bytes != 4)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: its record 0x%08lx, a coordinate system, has %lu bytes instead of 4: export it again", path,
                       (unsigned long)system_record, (unsigned long)bytes);
    const uint32_t system = td_le32(payload);
    if (system > SYSTEMS)
        return td_fail(error, TIDES_UNSUPPORTED,
                       "%s: its coordinate system %lu is none of 0 to %d, which TIDES knows: export it in one of these", path,
                       (unsigned long)system, SYSTEMS);
    found->system = system;
    return TIDES_OK;
}

static tides_status note_record(uint32_t type, td_spz_records *found, tides_error *error) {
    for (size_t i = 0; i < sizeof silent_records / sizeof silent_records[0]; i++)
        if (type == silent_records[i]) return TIDES_OK;
    if (type == place_record)
        return td_note(&found->notes, error, "its georeference isn't read: positions are in its local frame");
    return td_note(&found->notes, error, "its extension 0x%08lx isn't read", (unsigned long)type);
}

tides_status td_spz_read_records(const char *path, const unsigned char *bytes, size_t size, td_spz_records *found,
                                 tides_error *error) {
    tides_status status = TIDES_OK;
    while (size >= RECORD && !status) {
        const uint32_t type = td_le32(bytes), length = td_le32(bytes + 4);
        if (length > size - RECORD)
            return td_fail(error, TIDES_BAD_FILE, "%s: its extension 0x%08lx has %lu bytes, but %zu are left: truncated?", path,
                           (unsigned long)type, (unsigned long)length, size - RECORD);
        status =
            type == system_record ? read_system(path, bytes + RECORD, length, found, error) : note_record(type, found, error);
        bytes += RECORD + length;
        size -= RECORD + length;
    }
    return status;
}

td_spz_axes td_spz_axes_of(uint32_t system) {
    const uint32_t bits = (system ? system : RUB) - 1;
    const double right = bits & 1 ? 1 : -1, down = bits & 2 ? -1 : 1, front = bits & 4 ? 1 : -1;
    /* The turn exchanges y and z, so their flips are exchanged, too, and the turn comes last. */
    if (system > UNTURNED) return (td_spz_axes){{right, front, down}, 1};
    return (td_spz_axes){{right, down, front}, 0};
}

/* The sign of coefficient k. In band l, m runs from -l to l. The coefficient is odd in z if l + m is odd, and odd in y if
 * m < 0. It is odd in x if m >= 0 and m is odd, or if m < 0 and m is even. */
float td_spz_harmonic_sign(const double flips[3], size_t k) {
    int l = 0;
    while ((size_t)((l + 1) * (l + 1)) <= k) l++;
    const int m = (int)k - l * l - l, size = m < 0 ? -m : m;
    double sign = 1;
    if ((size - (m < 0)) % 2 != 0) sign *= flips[0];
    if (m < 0) sign *= flips[1];
    if ((l + m) % 2 != 0) sign *= flips[2];
    return (float)sign;
}

tides_status td_spz_turn(const td_spz_axes *axes, td_gaussians *gaussians, tides_error *error) {
    static const double quarter[12] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0}; /* the new y is the old z, the new z the old -y */
    return axes->turned ? td_gaussians_place(gaussians, quarter, error) : TIDES_OK;
}
