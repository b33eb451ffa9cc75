/* src/tui/pace.c, by a clock of the test's own: how often the screen is drawn, what share of a core it takes, how long a key waits. */
#include "check.h"

#include "tui/pace.h"

enum { REDRAWS = 4096 };

typedef struct history {
    double at[REDRAWS];
    int count;
} history;

/* `seconds` of a loop whose redraws take `cost`; something is to be drawn from the beginning on, and a key comes every `key_every` (0: never). */
static history run(double seconds, double cost, double key_every) {
    history h = {0};
    tui_pace p = {0};
    double now = 1000, end = now + seconds, key = key_every > 0 ? now + key_every : HUGE_VAL;
    while (now < end && h.count < REDRAWS) {
        if (now >= key) {
            pace_key(&p, now);
            key += key_every;
        }
        if (pace_due(&p, now)) {
            h.at[h.count++] = now;
            pace_drawn(&p, now, now + cost);
            now += cost;
        }
        double wait = pace_wait(&p, now, 1, true);
        now += fmin(wait, fmax(key - now, 0)) + 1e-4; /* poll's grain */
    }
    return h;
}

static int most_in_a_second(const history *h) {
    int most = 0;
    for (int i = 0, first = 0; i < h->count; i++) {
        while (h->at[i] - h->at[first] >= 1) first++;
        if (i - first + 1 > most) most = i - first + 1;
    }
    return most;
}

static void test_thirty_a_second(void) {
    history idle = run(10, 1e-4, 0), typing = run(10, 1e-3, 0.011);
    CHECK(most_in_a_second(&idle) <= 31 && idle.count >= 295);
    CHECK(most_in_a_second(&typing) <= 31 && typing.count >= 280);
}

static void test_share_of_a_core(void) {
    static const double costs[] = {2e-3, 8e-3, 0.03, 0.2};
    for (int i = 0; i < 4; i++) {
        history h = run(100, costs[i], 0);
        CHECK(h.count * costs[i] <= (pace_share + 1e-3) * 100 + costs[i]);
        CHECK(h.count * costs[i] >= 0.9 * pace_share * 100);
    }
}

/* A key is drawn at once when the screen rests, a redraw's distance after the last one otherwise, whatever redraws cost. */
static void test_keys_do_not_wait_for_the_share(void) {
    tui_pace p = {0};
    pace_drawn(&p, 10, 10.02);
    CHECK(!pace_due(&p, 10.5));
    pace_key(&p, 10.5);
    CHECK(pace_due(&p, 10.5));
    pace_drawn(&p, 10.5, 10.52);
    pace_key(&p, 10.521);
    CHECK(!pace_due(&p, 10.522));
    CHECK_NEAR(pace_wait(&p, 10.522, 1, true), pace_frame - 0.022, 1e-9);
    CHECK(pace_due(&p, 10.5 + pace_frame + 1e-9));
    /* A key puts nothing off. */
    tui_pace never = {0};
    pace_key(&never, 5);
    CHECK(pace_due(&never, 5));
}

static void test_rests_when_nothing_is_to_be_drawn(void) {
    tui_pace p = {0};
    CHECK(pace_wait(&p, 50, 0.25, false) == 0.25);
    CHECK(pace_wait(&p, 50, 0.25, true) == 0);
    CHECK(pace_wait(&p, 50, -1, false) == 0);
}

int main(void) {
    RUN(test_thirty_a_second);
    RUN(test_share_of_a_core);
    RUN(test_keys_do_not_wait_for_the_share);
    RUN(test_rests_when_nothing_is_to_be_drawn);
    return check_finish();
}
