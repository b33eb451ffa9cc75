/* make_run FOLDER: a small run with a gap in its frames, a solid and a sheet, for the checks by other programs. */
#include "scratch.h"

int main(int count, char **arguments) {
    static const int64_t frames[] = {0, 3, 6};
    report r;
    if (count != 2 || run_folder_create(arguments[1], false, &r)) return 2;
    for (int i = 0; i < 3; i++) {
        record_list list;
        frame_header header = header_of(frames[i]);
        fill_solid(&list, 20000, frames[i]); /* large enough for compressed chunks */
        fill_sheet(&list, 300);
        status s = frame_write(arguments[1], &header, &list, 1, &r);
        if (!s) s = checkpoint_write(arguments[1], &header, &list, &r);
        record_clear(&list);
        if (s) return 1;
    }
    return 0;
}
