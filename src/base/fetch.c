/* The only C of the program: an instruction that Fortran cannot name (see fetch.f90). */

void xmpm_fetch_lines(const double *values, int n);

/* Ask for the lines of the cache, 8 values each, that hold an array; nothing is read or waited for. */
void xmpm_fetch_lines(const double *values, int n)
{
    for (int i = 0; i < n; i += 8)
        __builtin_prefetch(values + i);
}
