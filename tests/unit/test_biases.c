/* Bias settings: eight sets of DAVIS cameras, in their own files' form, against a table's numbers; difficult cases of the
 * formats; and a run's messages about them. The table's numbers were computed from the sources, not by this code. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "run/td_biases.h"
#include "tides/run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/tides_biases_XXXXXX", path[128];

static int make_folder(void **state) {
    (void)state;
    return !mkdtemp(folder);
}

static int remove_folder(void **state) {
    (void)state;
    remove(path);
    return rmdir(folder);
}

static void write_text(const char *text) {
    snprintf(path, sizeof path, "%s/biases.txt", folder);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static td_biases read_text(const char *text) {
    td_biases biases;
    tides_error error = {TIDES_OK, ""};
    write_text(text);
    if (td_biases_read(path, &biases, &error) != TIDES_OK) fail_msg("%s", error.text);
    return biases;
}

/* diff, on, off, pr, sf, refr: coarse and fine. */
typedef struct set {
    const char *name;
    int32_t jaer, bias[6][2];
    double on, off, hz, refr_us; /* hz 0: SF > PR / 2 */
} set;

static const set sets[] = {
    {"libcaer 240", 0, {{4, 39}, {5, 255}, {4, 0}, {2, 58}, {1, 16}, {4, 25}}, 0.283, 0.262, 286, 3.4},
    {"libcaer 346", 0, {{4, 39}, {5, 255}, {4, 1}, {2, 58}, {1, 16}, {4, 25}}, 0.283, 0.262, 286, 3.4},
    {"libcaer 640H", 0, {{3, 75}, {6, 95}, {2, 41}, {1, 88}, {1, 173}, {2, 62}}, 0.462, 0.192, 0, 87},
    {"rpg DAVIS240C", 0, {{4, 39}, {6, 200}, {4, 0}, {2, 58}, {1, 33}, {4, 25}}, 0.414, 0.262, 590, 3.4},
    {"rpg miniDAVIS346", 0, {{4, 39}, {6, 255}, {4, 0}, {2, 255}, {1, 199}, {3, 7}}, 0.431, 0.262, 3560, 96},
    {"rpg indoors", 0, {{2, 39}, {4, 200}, {1, 62}, {3, 72}, {3, 96}, {3, 52}}, 0.414, 0.116, 0, 13},
    {"jAER DAVIS240C", 1, {{4, 92}, {6, 48}, {2, 160}, {2, 58}, {1, 16}, {4, 25}}, 0.251, 0.258, 288, 3.4},
    {"jAER 346blue", 1, {{4, 138}, {6, 45}, {2, 225}, {2, 6}, {0, 2}, {4, 25}}, 0.217, 0.262, 4.5, 3.4},
};

/* To the table's digits. */
static void expect_near(const char *name, const char *what, double found, double wanted, double half) {
    if (!(fabs(found - wanted) <= half)) fail_msg("%s: %s is %g, not %g", name, what, found, wanted);
}

static void print_set(const set *s, char *text, size_t size) {
    static const char *const jaer[] = {"DiffBn", "OnBn", "OffBn", "PrBp", "PrSFBp", "RefrBp"};
    static const char *const rpg[] = {"DiffBn", "ONBn", "OFFBn", "PrBp", "PrSFBp", "RefrBp"};
    size_t used =
        (size_t)snprintf(text, size, s->jaer ? "<?xml version=\"1.0\"?><map>\n" : "# a camera's\nADC_RefHigh_volt: 27\n");
    for (int i = 0; i < 6; i++)
        used += (size_t)(s->jaer ? snprintf(text + used, size - used,
                                            "  <entry key=\"DAVIS240C.AddressedIPotCF.%s.BitValueCoarse\" value=\"%d\"/>\n"
                                            "  <entry key=\"DAVIS240C.AddressedIPotCF.%s.BitValueFine\" value=\"%d\"/>\n"
                                            "  <entry key=\"DAVIS240C.AddressedIPotCF.%s.Enabled\" value=\"true\"/>\n",
                                            jaer[i], (int)(7 - s->bias[i][0]), jaer[i], (int)s->bias[i][1], jaer[i])
                                 : snprintf(text + used, size - used, "%s_coarse: %d\n%s_fine: %d\n", rpg[i],
                                            (int)s->bias[i][0], rpg[i], (int)s->bias[i][1]));
}

static void test_table(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
        const set *s = &sets[k];
        char text[4096];
        print_set(s, text, sizeof text);
        const td_biases biases = read_text(text);
        assert_int_equal(biases.kind, TD_BIASES_DAVIS);
        const td_bias_units u = td_biases_units(&biases);
        expect_near(s->name, "ON", u.threshold_on, s->on, 0.00101);
        expect_near(s->name, "OFF", u.threshold_off, s->off, 0.00101);
        expect_near(s->name, "f3dB", u.cutoff_hz, s->hz, 0.01 * s->hz);
        expect_near(s->name, "refr", 1e6 * u.refractory_s, s->refr_us, 0.03 * s->refr_us);
        assert_int_equal(u.limited, s->hz == 0);
        assert_int_equal(u.off, s->bias[2][1] == 0);
    }
}

/* As rpg_dvs_ros has it, in flow style; and what else jAER's files have. */
static void test_other_shapes(void **state) {
    (void)state;
    const td_biases flow = read_text("{DiffBn_coarse: 4, DiffBn_fine: 39, OFFBn_coarse: 4, OFFBn_fine: 0, ONBn_coarse: 6,\n"
                                     "  ONBn_fine: 200, PrBp_coarse: 2, PrBp_fine: 58, PrSFBp_coarse: 1, PrSFBp_fine: 33,\r\n"
                                     "  RefrBp_coarse: 4, RefrBp_fine: 25, aps_enabled: true, exposure: 4000}\n");
    const td_bias_units u = td_biases_units(&flow);
    expect_near("flow", "ON", u.threshold_on, 0.414, 0.001);
    expect_near("flow", "f3dB", u.cutoff_hz, 590, 5);
    const td_biases jaer = read_text("<entry key=\"ConfigurableIPot.bitViewEnabled\" value=\"true\"/>\n"
                                     "<entry key=\"AddressedIPotCF.OnBn.BitValueCoarse\" value=\"1\"/>\n"
                                     "<entry key=\"AddressedIPotCF.OnBn.BitValueFine\" value=\"45\"/>\n");
    assert_int_equal(jaer.count, 1);
    assert_int_equal(jaer.bias[0].coarse, 6);
    const td_biases codes = read_text("<entry key=\"PropheseeConfig.bias.diffOn\" value=\"130\"/>\n");
    assert_int_equal(codes.kind, TD_BIASES_PROPHESEE);
}

static void test_dvs128(void **state) {
    (void)state;
    const td_biases fast = read_text("cas: 54\ninjGnd: 1108364\ndiffOff: 132\nreq: 159147\nrefr: 969\ndiffOn: 209996\n"
                                     "diff: 13125\nfoll: 271\nPr: 217\n");
    assert_int_equal(fast.kind, TD_BIASES_DVS128);
    td_bias_units u = td_biases_units(&fast);
    expect_near("fast", "ON", u.threshold_on, 0.198, 0.001);
    expect_near("fast", "OFF", u.threshold_off, 0.329, 0.001);
    expect_near("fast", "refr", 1e6 * u.refractory_s, 35, 0.5);
    assert_true(u.limited && u.cutoff_hz == 0);
    const td_biases standard = read_text("<entry key=\"DVS128.IPot.diff\" value=\"30153\"/>\n<entry key=\"IPot.diffOn\" "
                                         "value=\"262144\"/>\n<entry key=\"IPot.diffOff\" value=\"132\"/>\n"
                                         "<entry key=\"IPot.refr\" value=\"6\"/>\n");
    u = td_biases_units(&standard);
    expect_near("standard", "ON", u.threshold_on, 0.154, 0.001);
    expect_near("standard", "OFF", u.threshold_off, 0.388, 0.001);
    expect_near("standard", "refr", 1e3 * u.refractory_s, 5.7, 0.05);
}

static void test_prophesee(void **state) {
    (void)state;
    const td_biases file =
        read_text("% a header\n300 % bias_diff\n0x181 % bias_diff_on (V)\n222 % bias_diff_off\n\n7 % bias_fo\n");
    assert_int_equal(file.kind, TD_BIASES_PROPHESEE);
    assert_int_equal(file.count, 3); /* the first empty line ends it */
    assert_int_equal(td_biases_find(&file, "bias_diff_on")->value, 385);
    td_biases settings = read_text("{\"ll_biases_state\": {\"bias\": [{\"name\": \"bias_fo\", \"value\": -35}, "
                                   "{\"name\": \"bias_hpf\", \"value\": 20}]}, \"afk_state\": {\"enabled\": true}}");
    assert_int_equal(settings.count, 2);
    assert_int_equal(td_biases_find(&settings, "BIAS_FO")->value, -35);
    td_biases_free(&settings);
}

/* An AEDAT 2 file goes on behind its header, with zeros in it. */
static void test_aedat(void **state) {
    (void)state;
    char text[4096] = "#!AER-DAT2.0\n# AEChip: eu.seebetter.ini.chips.davis.DAVIS240C\n#Start of Preferences for this AEChip\n";
    char entries[3000];
    print_set(&sets[6], entries, sizeof entries);
    for (char *line = strtok(entries, "\n"); line; line = strtok(NULL, "\n"))
        if (strstr(line, "<entry")) strcat(strcat(strcat(text, "#"), strstr(line, "<entry")), "\n");
    strcat(text, "#End of Preferences for this AEChip\n");
    write_text(text);
    FILE *file = fopen(path, "ab");
    assert_non_null(file);
    fwrite("\0\1\2\0\0\xff", 1, 6, file);
    fclose(file);
    td_biases biases;
    tides_error error = {TIDES_OK, ""};
    assert_int_equal(td_biases_read(path, &biases, &error), TIDES_OK);
    expect_near("aedat", "ON", td_biases_units(&biases).threshold_on, 0.251, 0.001);
}

/* A run with the file and two settings of its own: it is parsed, or refused with a line. */
static tides_run *run_with(const char *a, const char *b, const char *refused) {
    char key[200];
    snprintf(key, sizeof key, "sensor.biases=%s", path);
    const char *const given[] = {key, a, b};
    tides_run *run = NULL;
    tides_error error = {TIDES_OK, ""};
    const tides_status status = tides_run_parse("{\"frames\": {\"file\": \"-\"}}", "", given, b ? 3 : a ? 2 : 1, &run, &error);
    if (refused ? status == TIDES_OK || !strstr(error.text, refused) : status != TIDES_OK) fail_msg("%s", error.text);
    return run;
}

static void expect_note(const tides_run *run, const char *text) {
    if (!strstr(tides_run_notes(run), text)) fail_msg("\"%s\" isn't in:\n%s", text, tides_run_notes(run));
}

static void test_run(void **state) {
    (void)state;
    tides_run_values v;
    char text[4096];
    print_set(&sets[3], text, sizeof text);
    write_text(text);
    tides_run *run = run_with("sensor.preset=davis346", "sensor.threshold_on=0.5", NULL);
    tides_run_get(run, &v);
    assert_true(v.sensor.threshold_on == 0.5);
    expect_near("run", "OFF", v.sensor.threshold_off, 0.262, 0.001);
    expect_near("run", "pole", v.sensor.photoreceptor_cutoff_hz, 590, 5);
    expect_note(run, "ON and diff would be sensor.threshold_on 0.41");
    expect_note(run, "OFF (fine 0: off; taken as 1) and diff: sensor.threshold_off 0.26");
    tides_run_destroy(run);
    print_set(&sets[2], text, sizeof text);
    write_text(text);
    run = run_with("sensor.preset=davis346", NULL, NULL);
    tides_run_get(run, &v);
    assert_true(v.sensor.photoreceptor_cutoff_hz == 45.5); /* the preset's */
    expect_note(run, "frontend.photoreceptor_cutoff_hz is kept: the photoreceptor is slower");
    tides_run_destroy(run);
    write_text("300 % bias_diff\n470 % bias_diff_on\n222 % bias_diff_off\n1480 % bias_fo\n");
    run = run_with("sensor.preset=gen3", NULL, NULL);
    tides_run_get(run, &v);
    expect_near("gen3", "ON", v.sensor.threshold_on, 0.3, 1e-12); /* twice the distance */
    expect_near("gen3", "OFF", v.sensor.threshold_off, 0.1, 1e-12);
    expect_note(run, "by TIDES' own law");
    expect_note(run, "bias_fo 1480: kept");
    tides_run_destroy(run);
    run = run_with("sensor.preset=imx636", NULL, NULL);
    tides_run_get(run, &v);
    assert_true(v.sensor.threshold_on == 0.223);
    expect_note(run, "bias_diff_on 470, bias_diff_off 222, bias_fo 1480: kept");
    tides_run_destroy(run);
}

/* The filters of Metavision's settings: those that are on, with a line each; a key that is given wins. */
static void test_filters(void **state) {
    (void)state;
    tides_run_values v;
    write_text(
        "{\"ll_biases_state\": {\"bias\": [{\"name\": \"bias_fo\", \"value\": -35}]},"
        "\"afk_state\": {\"enabled\": true, \"band_low_freq\": 90, \"band_high_freq\": 130, \"filtering_mode\": "
        "\"BAND_PASS\", \"duty_cycle\": 0.5, \"start_threshold\": 5, \"stop_threshold\": 3},"
        "\"event_trail_filter_state\": {\"enabled\": true, \"filtering_type\": \"STC_KEEP_TRAIL\", \"threshold\": 25000},"
        "\"event_rate_control_state\": {\"enabled\": true, \"cd_event_count\": 4000},"
        "\"event_rate_noise_filter_state\": {\"enabled\": true, \"event_rate_threshold\": 7},"
        "\"event_rate_activity_filter_state\": {\"enabled\": false, \"lower_start_rate_threshold\": 9}}");
    tides_run *run = run_with("filters.afk_start=6", NULL, NULL);
    tides_run_get(run, &v);
    assert_true(v.filters.afk == TIDES_AFK_BAND_PASS && v.filters.afk_low_hz == 90 && v.filters.afk_high_hz == 130);
    assert_true(v.filters.afk_start == 6 && v.filters.afk_stop == 3);
    assert_true(v.filters.trail == TIDES_TRAIL_STC_KEEP && fabs(v.filters.trail_s - 0.025) < 1e-12);
    assert_true(v.filters.erc_events == 4000 && v.filters.activity_low_start == 0);
    expect_note(run, "afk_state.filtering_mode: filters.afk \"band_pass\"");
    expect_note(run, "afk_state.start_threshold would be filters.afk_start 5, which is given otherwise");
    expect_note(run, "afk_state.duty_cycle: has no key");
    tides_run_destroy(run);
    write_text("{\"ll_biases_state\": {\"bias\": [{\"name\": \"bias_fo\", \"value\": 0}]}, \"event_rate_noise_filter_state\": "
               "{\"enabled\": true, \"event_rate_threshold\": 7}, \"event_rate_control_state\": {\"enabled\": false, "
               "\"cd_event_count\": 5}}");
    run = run_with(NULL, NULL, NULL);
    tides_run_get(run, &v);
    assert_true(v.filters.activity_low_start == 7 && v.filters.erc_events == 0 && v.filters.afk == TIDES_AFK_OFF);
    tides_run_destroy(run);
    static const char *const wrong[][2] = {{"\"filtering_type\": \"NEW\"", "filtering_type has no value for filters.trail"},
                                           {"\"threshold\": -1", "filters.trail_s"},
                                           {"\"threshold\": \"x\"", "threshold has no value for filters.trail_s"}};
    for (size_t i = 0; i < 3; i++) {
        char text[400];
        snprintf(text, sizeof text,
                 "{\"ll_biases_state\": {\"bias\": [{\"name\": \"bias_fo\", \"value\": 0}]}, \"event_trail_filter_state\": "
                 "{\"enabled\": true, %s}}",
                 wrong[i][0]);
        write_text(text);
        tides_run_destroy(run_with(NULL, NULL, wrong[i][1]));
    }
}

static void test_refused(void **state) {
    (void)state;
    static const char *const texts[] =
        {"", "{\"ll_biases_state\": {}}", "{", "nothing: here\n", "<entry key=\"a", "<entry key=\"x\" value=\"1\"/>"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        write_text(texts[i]);
        tides_run_destroy(run_with(NULL, NULL, "sensor.biases: "));
    }
    write_text("DiffBn_coarse: 99\nDiffBn_fine: 99999\nONBn_coarse: -4\n"); /* nothing of it is a current */
    tides_run *run = run_with(NULL, NULL, NULL);
    expect_note(run, "sensor.threshold_on is kept: its biases aren't in the file");
    tides_run_destroy(run);
    snprintf(path, sizeof path, "%s/none.bias", folder);
    tides_run_destroy(run_with(NULL, NULL, "can't be opened"));
    snprintf(path, sizeof path, "%s/biases.txt", folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_table),   cmocka_unit_test(test_other_shapes),
                                       cmocka_unit_test(test_dvs128),  cmocka_unit_test(test_prophesee),
                                       cmocka_unit_test(test_aedat),   cmocka_unit_test(test_run),
                                       cmocka_unit_test(test_filters), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
