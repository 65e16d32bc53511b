/* Deflate's codes: Huffman's, of bounded length, and how a block tells them (RFC 1951, 3.2.2 and 3.2.7). */
#include "td_deflate_code.h"

#include <stdlib.h>
#include <string.h>

enum { LONGEST = 15, LONGEST_TELL = 7, TELLS = 19, SYMBOL_BITS = 9 };

/* -- lengths --------------------------------------------------------------------------------------------------------------- */

static int by_number(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Huffman's tree over `count` >= 2 ascending weights: how many leaves lie how deep. Two queues, leaves and pairs, both in
 * order: the next pair is of the two least heads. */
static void count_depths(const uint64_t *weight, int count, uint32_t *at_depth) {
    uint64_t pair[TD_SYMBOLS];
    int parent_of_leaf[TD_SYMBOLS], parent_of_pair[TD_SYMBOLS], depth[TD_SYMBOLS], leaf = 0, first = 0;
    for (int made = 0; made < count - 1; made++) {
        pair[made] = 0;
        for (int side = 0; side < 2; side++) {
            if (leaf < count && (first == made || weight[leaf] <= pair[first])) {
                pair[made] += weight[leaf];
                parent_of_leaf[leaf++] = made;
            } else {
                pair[made] += pair[first];
                parent_of_pair[first++] = made;
            }
        }
    }
    depth[count - 2] = 0;
    for (int k = count - 3; k >= 0; k--) depth[k] = depth[parent_of_pair[k]] + 1;
    for (int k = 0; k < count; k++) {
        const int d = depth[parent_of_leaf[k]] + 1;
        at_depth[d]++;
    }
}

/* What is deeper than `longest` comes up, and others go down until all find room: Kraft's sum is 1 again. */
static void bound_depths(uint32_t *at_depth, int deepest, int longest) {
    uint64_t taken = 0;
    for (int d = longest + 1; d <= deepest; d++) {
        at_depth[longest] += at_depth[d];
        at_depth[d] = 0;
    }
    for (int d = 1; d <= longest; d++) taken += (uint64_t)at_depth[d] << (longest - d);
    for (; taken > (uint64_t)1 << longest; taken--) {
        int d = longest - 1;
        while (at_depth[d] == 0) d--;
        at_depth[longest]--; /* one leaf of the longest joins one that goes down by one */
        at_depth[d]--;
        at_depth[d + 1] += 2;
    }
}

/* Canonical codes, in the order of symbols at each length, the first bit lowest. */
static void number_codes(td_code *code, int symbols, const uint32_t *at_depth, int longest) {
    uint32_t next[LONGEST + 2] = {0};
    for (int d = 1; d <= longest; d++) next[d + 1] = (next[d] + at_depth[d]) << 1;
    for (int k = 0; k < symbols; k++) {
        uint32_t number = code[k].length ? next[code[k].length]++ : 0, turned = 0;
        for (int bit = 0; bit < code[k].length; bit++, number >>= 1) turned = turned << 1 | (number & 1);
        code[k].bits = (uint16_t)turned;
    }
}

/* Codes of the symbols that were seen, none longer than `longest`; at least one symbol was. */
static void make_code(td_code *code, const uint32_t *seen, int symbols, int longest) {
    uint64_t order[TD_SYMBOLS], weight[TD_SYMBOLS];
    uint32_t at_depth[TD_SYMBOLS + 1] = {0};
    int count = 0;
    memset(code, 0, (size_t)symbols * sizeof *code);
    for (int k = 0; k < symbols; k++)
        if (seen[k]) order[count++] = (uint64_t)seen[k] << SYMBOL_BITS | (uint64_t)k;
    qsort(order, (size_t)count, sizeof *order, by_number);
    for (int k = 0; k < count; k++) weight[k] = order[k] >> SYMBOL_BITS;
    if (count == 1)
        at_depth[1] = 1;
    else
        count_depths(weight, count, at_depth);
    bound_depths(at_depth, TD_SYMBOLS, longest);
    int k = 0;
    for (int d = longest; d > 0; d--) /* the rarest get the longest */
        for (uint32_t n = 0; n < at_depth[d]; n++) code[order[k++] & ((1 << SYMBOL_BITS) - 1)].length = (uint8_t)d;
    number_codes(code, symbols, at_depth, longest);
}

/* -- telling them ---------------------------------------------------------------------------------------------------------- */

enum { REPEAT = 16, ZEROS = 17, MANY_ZEROS = 18 };

/* `run` times this length. */
static void tell_run(td_codes *codes, uint32_t length, int run) {
    td_extra *const told = codes->told;
    while (length == 0 && run >= 3) {
        const int n = run < 138 ? run : 138;
        told[codes->told_count++] =
            n < 11 ? (td_extra){ZEROS, (uint32_t)n - 3, 3} : (td_extra){MANY_ZEROS, (uint32_t)n - 11, 7};
        run -= n;
    }
    if (run > 0) {
        told[codes->told_count++] = (td_extra){length, 0, 0};
        run--;
    }
    while (length != 0 && run >= 3) {
        const int n = run < 6 ? run : 6;
        told[codes->told_count++] = (td_extra){REPEAT, (uint32_t)n - 3, 2};
        run -= n;
    }
    while (run-- > 0) told[codes->told_count++] = (td_extra){length, 0, 0};
}

static int used(const td_code *code, int count, int least) {
    while (count > least && code[count - 1].length == 0) count--;
    return count;
}

static void tell(td_codes *codes) {
    uint8_t lengths[TD_SYMBOLS + TD_DISTANCES];
    int count = 0;
    codes->symbols = used(codes->symbol, TD_SYMBOLS, 257);
    codes->distances = used(codes->distance, TD_DISTANCES, 1);
    for (int k = 0; k < codes->symbols; k++) lengths[count++] = codes->symbol[k].length;
    for (int k = 0; k < codes->distances; k++) lengths[count++] = codes->distance[k].length;
    codes->told_count = 0;
    for (int k = 0, run; k < count; k += run) {
        for (run = 1; k + run < count && lengths[k + run] == lengths[k]; run++) {
        }
        tell_run(codes, lengths[k], run);
    }
}

/* In the order of which lengths of their codes are told: the likeliest not to be there come last. */
static const uint8_t order_of_tells[TELLS] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};

static uint64_t bits_of(const td_code *code, const uint32_t *seen, int symbols) {
    uint64_t bits = 0;
    for (int k = 0; k < symbols; k++) bits += (uint64_t)seen[k] * code[k].length;
    return bits;
}

uint64_t td_codes_make(td_codes *codes, const uint32_t *symbols, const uint32_t *distances) {
    uint32_t seen[TELLS] = {0}, some[TD_DISTANCES];
    memcpy(some, distances, sizeof some);
    int any = 0;
    for (int k = 0; k < TD_DISTANCES; k++) any |= some[k] != 0;
    if (!any) some[0] = 1; /* readers want one code */
    make_code(codes->symbol, symbols, TD_SYMBOLS, LONGEST);
    make_code(codes->distance, some, TD_DISTANCES, LONGEST);
    tell(codes);
    seen[0] = seen[MANY_ZEROS] = 1; /* two at least, or their code would have an end that leads nowhere */
    uint64_t bits = 3 + 14 + bits_of(codes->symbol, symbols, TD_SYMBOLS) + bits_of(codes->distance, distances, TD_DISTANCES);
    for (int k = 0; k < codes->told_count; k++) seen[codes->told[k].symbol]++;
    make_code(codes->tell, seen, TELLS, LONGEST_TELL);
    codes->tells = TELLS;
    while (codes->tells > 4 && codes->tell[order_of_tells[codes->tells - 1]].length == 0) codes->tells--;
    for (int k = 0; k < codes->told_count; k++) bits += codes->tell[codes->told[k].symbol].length + codes->told[k].bits;
    for (int k = 0; k < TD_SYMBOLS; k++) /* what follows copies' symbols */
        if (k > TD_END_OF_BLOCK + 8 && k < 285) bits += (uint64_t)symbols[k] * (unsigned)((k - 261) / 4);
    for (int k = 4; k < TD_DISTANCES; k++) bits += (uint64_t)distances[k] * (unsigned)(k / 2 - 1);
    return bits + 3 * (unsigned)codes->tells;
}

void td_codes_put(td_bits *out, const td_codes *codes, int is_last) {
    td_bits_put(out, (uint32_t)is_last | 2u << 1, 3); /* codes of its own */
    td_bits_put(out, (uint32_t)(codes->symbols - 257), 5);
    td_bits_put(out, (uint32_t)(codes->distances - 1), 5);
    td_bits_put(out, (uint32_t)(codes->tells - 4), 4);
    for (int k = 0; k < codes->tells; k++) td_bits_put(out, codes->tell[order_of_tells[k]].length, 3);
    for (int k = 0; k < codes->told_count; k++) {
        const td_extra *t = &codes->told[k];
        td_bits_put(out, codes->tell[t->symbol].bits, codes->tell[t->symbol].length);
        td_bits_put(out, t->extra, t->bits);
    }
}
