#include "script/place.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

place place_key(const place *from, const char *key) {
    place p = *from;
    if (p.depth < PLACE_DEPTH) p.path[p.depth++] = (place_step){.key = key};
    return p;
}

place place_index(const place *from, int index) {
    place p = *from;
    if (p.depth < PLACE_DEPTH) p.path[p.depth++] = (place_step){.index = index};
    return p;
}

void place_text(const place *p, char *text, size_t size) {
    size_t used = 0;
    if (size > 0) snprintf(text, size, "%s", p->depth == 0 && p->call ? p->call : "");
    for (int i = 0; i < p->depth && used < size; i++) {
        const place_step *step = &p->path[i];
        int n = step->key ? snprintf(text + used, size - used, "%s%s", i ? "." : "", step->key)
                          : snprintf(text + used, size - used, "[%d]", step->index);
        if (n > 0) used += (size_t)n;
    }
}

/* ---- tokens ------------------------------------------------------------------------------------------------------ */

typedef enum token_kind { TOKEN_END, TOKEN_NAME, TOKEN_STRING, TOKEN_SYMBOL, TOKEN_OTHER } token_kind;

typedef struct token {
    token_kind kind;
    char symbol;       /* of single-character symbols */
    const char *start; /* of names, and of a string's content */
    size_t size;
    int line;
} token;

typedef struct lexer {
    const char *at, *end;
    int line;
} lexer;

static bool token_is(const token *t, const char *word) {
    return (t->kind == TOKEN_NAME || t->kind == TOKEN_STRING) && t->size == strlen(word) &&
           memcmp(t->start, word, t->size) == 0;
}

static bool name_is(const token *t, const char *word) {
    return t->kind == TOKEN_NAME && token_is(t, word);
}

static bool symbol_is(const token *t, char symbol) {
    return t->kind == TOKEN_SYMBOL && t->symbol == symbol;
}

/* The level of a long bracket that opens here ("[==[" is 2), or -1. */
static int long_bracket(const lexer *x) {
    const char *p = x->at;
    if (p >= x->end || *p != '[') return -1;
    int level = 0;
    for (p++; p < x->end && *p == '='; p++) level++;
    return p < x->end && *p == '[' ? level : -1;
}

static void read_long(lexer *x, int level, token *t) {
    x->at += level + 2;
    t->start = x->at;
    for (; x->at < x->end; x->at++) {
        if (*x->at == '\n') x->line++;
        if (*x->at != ']' || x->end - x->at < level + 2) continue;
        int same = 0;
        while (same < level && x->at[1 + same] == '=') same++;
        if (same < level || x->at[1 + level] != ']') continue;
        t->size = (size_t)(x->at - t->start);
        x->at += level + 2;
        return;
    }
    t->size = (size_t)(x->end - t->start);
}

static void skip_blank(lexer *x) {
    while (x->at < x->end) {
        if (*x->at == '\n') x->line++;
        if (isspace((unsigned char)*x->at)) {
            x->at++;
        } else if (x->end - x->at >= 2 && x->at[0] == '-' && x->at[1] == '-') {
            x->at += 2;
            int level = long_bracket(x);
            token ignored;
            if (level >= 0)
                read_long(x, level, &ignored);
            else
                while (x->at < x->end && *x->at != '\n') x->at++;
        } else {
            return;
        }
    }
}

static void read_quoted(lexer *x, token *t) {
    char quote = *x->at++;
    t->start = x->at;
    for (; x->at < x->end && *x->at != quote; x->at++) {
        if (*x->at == '\\' && x->at + 1 < x->end) x->at++;
        if (*x->at == '\n') x->line++;
    }
    t->size = (size_t)(x->at - t->start);
    if (x->at < x->end) x->at++;
}

static token next_token(lexer *x) {
    skip_blank(x);
    token t = {.kind = TOKEN_END, .line = x->line, .start = x->at};
    if (x->at >= x->end) return t;
    unsigned char c = (unsigned char)*x->at;
    int level = long_bracket(x);
    if (isalpha(c) || c == '_') {
        t.kind = TOKEN_NAME;
        while (x->at < x->end && (isalnum((unsigned char)*x->at) || *x->at == '_')) x->at++;
        t.size = (size_t)(x->at - t.start);
    } else if (isdigit(c)) {
        t.kind = TOKEN_OTHER; /* exponents' signs become symbols of their own: nothing here minds */
        while (x->at < x->end && (isalnum((unsigned char)*x->at) || *x->at == '.')) x->at++;
    } else if (c == '"' || c == '\'') {
        t.kind = TOKEN_STRING;
        read_quoted(x, &t);
    } else if (level >= 0) {
        t.kind = TOKEN_STRING;
        read_long(x, level, &t);
    } else if (x->end - x->at >= 2 && x->at[1] == '=' && strchr("=~<>", c)) {
        t.kind = TOKEN_OTHER; /* comparisons are no assignments */
        x->at += 2;
    } else {
        t.kind = TOKEN_SYMBOL;
        t.symbol = (char)c;
        x->at++;
    }
    return t;
}

/* How much deeper the code is nested after this token: brackets, and blocks that end in `end` or `until`. */
static int nesting(const token *t) {
    if (t->kind == TOKEN_SYMBOL && strchr("({[", t->symbol)) return 1;
    if (t->kind == TOKEN_SYMBOL && strchr(")}]", t->symbol)) return -1;
    static const char *const openers[] = {"function", "if", "do", "repeat"};
    for (size_t i = 0; i < sizeof openers / sizeof *openers; i++)
        if (name_is(t, openers[i])) return 1;
    return name_is(t, "end") || name_is(t, "until") ? -1 : 0;
}

/* ---- following a path -------------------------------------------------------------------------------------------- */

/* Reads the head of one field; afterwards the lexer stands at its value. False for a positional field, nothing
 * consumed. */
static bool read_field_name(lexer *x, token *name) {
    lexer ahead = *x;
    token first = next_token(&ahead);
    if (first.kind == TOKEN_NAME) {
        token equals = next_token(&ahead);
        if (!symbol_is(&equals, '=')) return false;
        *name = first;
    } else if (symbol_is(&first, '[')) {
        *name = next_token(&ahead);
        token close = next_token(&ahead), equals = next_token(&ahead);
        if (!symbol_is(&close, ']') || !symbol_is(&equals, '=')) return false;
    } else {
        return false;
    }
    *x = ahead;
    return true;
}

/* Skips a value; false when the table ended with it. */
static bool skip_value(lexer *x) {
    for (int depth = 0;;) {
        token t = next_token(x);
        if (t.kind == TOKEN_END) return false;
        depth += nesting(&t);
        if (depth < 0) return false;
        if (depth == 0 && (symbol_is(&t, ',') || symbol_is(&t, ';'))) return true;
    }
}

/* From just behind an opening brace to the value of one field; its line, or 0 when it is not there. */
static int find_field(lexer *x, const place_step *step) {
    int position = 0;
    do {
        lexer ahead = *x;
        token first = next_token(&ahead), name;
        if (first.kind == TOKEN_END || symbol_is(&first, '}')) return 0;
        bool named = read_field_name(x, &name);
        if (!named) position++;
        if (step->key ? named && token_is(&name, step->key) : !named && position == step->index) return first.line;
    } while (skip_value(x));
    return 0;
}

/* Finds "name = {" anywhere before `limit`: the last one stands. */
static bool find_variable(const char *text, const char *limit, const token *variable, lexer *x) {
    lexer scan = {text, limit, 1};
    bool found = false;
    token back2 = {0}, back1 = {0};
    for (token t = next_token(&scan); t.kind != TOKEN_END; back2 = back1, back1 = t, t = next_token(&scan)) {
        if (!symbol_is(&t, '{') || !symbol_is(&back1, '=') || back2.kind != TOKEN_NAME) continue;
        if (back2.size != variable->size || memcmp(back2.start, variable->start, back2.size) != 0) continue;
        *x = scan;
        found = true;
    }
    return found;
}

/* From the start of a value to just behind the brace of the table that it is, or that it calls something with. */
static bool enter_table(const char *text, lexer *x) {
    token first = {0};
    bool in_call = false; /* s.recipe("tube", { … }) */
    for (int count = 0; count < 8; count++) {
        lexer before = *x;
        token t = next_token(x);
        if (count == 0) first = t;
        if (symbol_is(&t, '{')) return true;
        bool ends = t.kind == TOKEN_END || symbol_is(&t, ',') || symbol_is(&t, '}') || symbol_is(&t, ';');
        in_call = in_call || symbol_is(&t, '(');
        if (!ends || (in_call && symbol_is(&t, ','))) continue;
        const char *end = before.end;
        if (count != 1 || first.kind != TOKEN_NAME || !find_variable(text, first.start, &first, x)) return false;
        x->end = end;
        return true;
    }
    return false;
}

/* The lexer behind the last `return`. */
static lexer find_return(const char *text, size_t size, int *line) {
    lexer x = {text, text + size, 1}, found = x;
    *line = 1;
    for (token t = next_token(&x); t.kind != TOKEN_END; t = next_token(&x))
        if (name_is(&t, "return")) found = x, *line = t.line;
    return found;
}

/* The lexer behind the word `call` on or after the given line, or at the start of that line when there is no such word.
 */
static lexer find_call(const char *text, size_t size, int line, const char *call) {
    lexer x = {text, text + size, 1}, before = x;
    token t = next_token(&x);
    while (t.kind != TOKEN_END && t.line < line) before = x, t = next_token(&x);
    lexer at_line = before;
    for (int count = 0; call && count < 64 && t.kind != TOKEN_END; count++, t = next_token(&x))
        if (name_is(&t, call)) return x;
    return at_line;
}

int place_find(const place *p, const char *text, size_t size) {
    int line = p->line;
    lexer x = p->line > 0 ? find_call(text, size, p->line, p->call) : find_return(text, size, &line);
    for (int i = 0; i < p->depth; i++) {
        if (!enter_table(text, &x)) break;
        int found = find_field(&x, &p->path[i]);
        if (!found) break;
        line = found;
    }
    return line;
}
