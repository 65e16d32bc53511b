/* The list of a tile's swaps of depth (td_swaps.h), and sums of those that happen at once. All pairs of a coplanar sheet that
 * turns past the camera swap at one time: 400 splats that overlap fourfold made 7 million swaps in 192 blocks, which took 20
 * times as long as all else. */
#include "td_extremes.h"
#include "td_swaps.h"

#include <string.h>

/* Swaps of a tile that are listed each by itself; the rest is summed. */
enum { MOST_APART = 512 };

td_swap_sum *td_swaps_sum(const td_swap_tile *tile, int32_t part, float wide) {
    td_swap_portion *in = tile->portion;
    uint32_t length;
    if (in->count < tile->before + MOST_APART) return NULL;
    memcpy(&length, &wide, sizeof length);
    length >>= 22; /* halves of octaves */
    td_swap_sum *sum = &in->sum[((uint32_t)part * 31 + length) % TD_SWAP_SUMS];
    if (sum->part != part || sum->length != length) {
        *sum = (td_swap_sum){.part = part, .length = length};
        memset(sum->at, -1, sizeof sum->at);
    }
    return sum;
}

void td_swaps_add(td_swap_tile *tile, const td_swap *swap, td_swap_sum *sum) {
    td_swap_portion *to = tile->portion;
    const int block = swap->block % TD_TILE_BLOCKS;
    if (sum && sum->at[block] >= 0) {
        td_swap *all = &to->swap[sum->at[block]];
        all->light += swap->light;
        if (all->light < tile->most_light) return;
        all->light = tile->most_light;
        sum->whole |= 1u << block;
        return;
    }
    tile->status = td_reserve((void **)&to->swap, &to->swap_capacity, to->count + 1, sizeof *to->swap, tile->error);
    if (tile->status != TIDES_OK) return;
    if (sum) sum->at[block] = (int32_t)to->count;
    to->swap[to->count++] = *swap;
    if (to->count == tile->before + MOST_APART) memset(to->sum, 0, sizeof to->sum); /* no part is 0 */
}
