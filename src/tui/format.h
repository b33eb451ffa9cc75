/* Numbers for people, in widths that do not change while they run. */
#ifndef SUNDER_TUI_FORMAT_H
#define SUNDER_TUI_FORMAT_H

#include <stdint.h>

enum { FORMAT_BYTES = 32 };

/* 12 345 678 if that fits into `columns`, else 12.346 M. */
void format_count(int64_t count, int columns, char text[FORMAT_BYTES]);

/* Nine columns: 1.234e-03; "–" when not finite. */
void format_real(double value, char text[FORMAT_BYTES]);

/* Wall time as h:mm:ss; "–" when not known (negative or not finite). */
void format_clock(double seconds, char text[FORMAT_BYTES]);

/* Seven columns with unit: 12.3 ms, 0.842 s, 12.34 s, 123.4 s. */
void format_seconds(double seconds, char text[FORMAT_BYTES]);

/* Seven columns: 12.34 %, <0.01 % when that is not nothing. */
void format_percent(double fraction, char text[FORMAT_BYTES]);

#endif
