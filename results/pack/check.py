"""Compares answers with the exact values of the pack: python3 check.py ANSWERS.csv, columns id, value, std_error.
z is the difference over the root of the summed squares of the answer's standard error and the value's bound. Answers disagree, exit
code 1, where chance gives a larger sum of squares, or one z as large, with a probability below 1e-4. Wrong files: one line, exit code 2."""
import contextlib, csv, math, os, sys
LEVEL, MOST_LINES = 1e-4, 10_000

def fail(message):
    sys.exit(print(f"error: {message}", file=sys.stderr) or 2)

def read(path, columns):
    try:
        with open(path, newline="", encoding="utf-8-sig") as file:
            rows = csv.DictReader(file, strict=True)
            for column in columns:
                if (rows.fieldnames or []).count(column) != 1:
                    fail(f"{path}, line 1: not one column {column}; needed: {', '.join(columns)}")
            for row in rows:
                if rows.line_num > MOST_LINES:
                    fail(f"{path}: more than {MOST_LINES} lines; allowed: one a question")
                if None in row or None in row.values():
                    fail(f"{path}, line {rows.line_num}: not {len(rows.fieldnames)} fields, as in line 1")
                yield f"{path}, line {rows.line_num}", row
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        fail(f"{path}: {error}")

def number(row, column, place, least):
    with contextlib.suppress(ValueError):
        if math.isfinite(x := float(row[column])) and x >= least:
            return x
    fail(f"{place}: {column} is {str(row[column])[:40]!r}; allowed: a finite number{', at least 0' if least == 0 else ''}")

def chi_squared_p(x, n):  # Q(n/2, x/2), by its recurrence in steps of 1
    y, a = min(x / 2, 1e5), n % 2 / 2
    p = math.erfc(math.sqrt(y)) if a else 0.0
    while y > 0 and a < n / 2:
        p, a = p + math.exp(a * math.log(y) - y - math.lgamma(a + 1)), a + 1
    return min(p, 1.0) if y > 0 else 1.0
def main(path):
    questions = {q["id"]: q for _, q in read(os.path.join(os.path.dirname(os.path.abspath(__file__)), "questions.csv"), ["id"])}
    zs, lines = {}, []
    for place, row in read(path, ["id", "value", "std_error"]):
        name = row["id"]
        if name not in questions or name in zs:
            fail(f"{place}: id {str(name)[:60]!r} is {'answered twice' if name in zs else 'not in questions.csv'}")
        value, error = number(row, "value", place, -math.inf), number(row, "std_error", place, 0)
        exact, bound = (float(questions[name][column]) for column in ("value", "bound"))
        zs[name] = (value - exact) / math.hypot(error, bound)
        lines.append(f"{name:46} exact {exact:<13.7g} answer {value:<13.7g} error {error:<8.2g} z {zs[name]:8.2f}")
    zs or fail(f"{path}: no answers; needed: at least one")
    x, worst = sum(z * z for z in zs.values()), max(zs, key=lambda name: abs(zs[name]))
    p, one = chi_squared_p(x, len(zs)), min(1.0, len(zs) * math.erfc(abs(zs[worst]) / math.sqrt(2)))
    lines.append(f"{len(zs)} of {len(questions)} questions, chi-squared {x:.4g}, p {p:.2g}; largest z {zs[worst]:.2f} ({worst}), p {one:.2g}")
    lines.append("disagrees" if min(p, one) < LEVEL else "agrees")
    try:
        print("\n".join(lines), flush=True)
    except OSError as error:
        os._exit(print(f"error: standard output: {error.strerror}", file=sys.stderr) or 2)
    sys.exit(min(p, one) < LEVEL)

main(sys.argv[1]) if len(sys.argv) == 2 else fail("needed: check.py ANSWERS.csv")
