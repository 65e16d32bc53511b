/* Any bytes as a chunk of Prophesee's codec: at most as many events as there is room for, or refused. */
#include "fuzz.h"

#include "events/td_ecf.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static tides_event events[TD_ECF_CHUNK];
    size_t count = 0, room = size % 3 ? TD_ECF_CHUNK : size;
    if (!td_ecf_unpack(data, size, events, room, &count)) return 0;
    if (count > room) abort();
    for (size_t i = 0; i < count; i++)
        if (events[i].polarity != 1 && events[i].polarity != -1) abort();
    return 0;
}
