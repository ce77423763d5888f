# The R half of make_statistics.py: reads "kind name columns rows values..." lines (values row by row) from stdin
# and writes "name key value..." lines, 17 digits. Base R only.

say <- function(name, key, values) cat(name, key, sprintf("%.17g", values), "\n")

all_pairs <- function(k) combn(k, 2, simplify = FALSE)

say_pairs <- function(name, key, k, one) {
    rows <- sapply(all_pairs(k), function(ij) one(ij[1], ij[2], choose(k, 2)))
    p <- rows["p", ]
    for (field in rownames(rows)) say(name, paste0(key, ".", field), rows[field, ])
    say(name, paste0(key, ".p_bonferroni"), p.adjust(p, "bonferroni"))
    say(name, paste0(key, ".p_holm"), p.adjust(p, "holm"))
}

pooled <- function(difference, error, df, family) {
    half <- qt(0.025, df, lower.tail = FALSE) * error
    half_all <- qt(0.025 / family, df, lower.tail = FALSE) * error
    t <- difference / error
    c(difference = difference, t = t, df = df, p = 2 * pt(abs(t), df, lower.tail = FALSE),
      low = difference - half, high = difference + half,
      low_all = difference - half_all, high_all = difference + half_all)
}

repeated <- function(name, m) {
    n <- nrow(m)
    k <- ncol(m)
    d <- data.frame(y = c(m), condition = gl(k, n), subject = factor(rep(1:n, k)))
    strata <- summary(aov(y ~ condition + Error(subject), data = d))
    within <- strata[["Error: Within"]][[1]]
    say(name, "anova.ss", c(within[1:2, "Sum Sq"], strata[["Error: subject"]][[1]][1, "Sum Sq"]))
    say(name, "anova.df", within[1:2, "Df"])
    say(name, "anova.f", within[1, "F value"])
    say(name, "anova.p", within[1, "Pr(>F)"])
    if (k <= n - 1) {
        fit <- lm(m ~ 1)
        # What anova.mlm prints with five digits only.
        contrasts <- t(contr.helmert(k))
        epsilons <- stats:::sphericity(SSD(fit), T = contrasts / sqrt(rowSums(contrasts^2)))
        say(name, "anova.epsilons", c(epsilons$GG.eps, min(1, epsilons$HF.eps)))
        spherical <- anova(fit, X = ~1, test = "Spherical")
        say(name, "anova.p_corrected", c(spherical[1, "G-G Pr"], spherical[1, "H-F Pr"]))
    }
    mse <- within[2, "Mean Sq"]
    say_pairs(name, "pooled", k, function(i, j, family)
        pooled(mean(m[, i] - m[, j]), sqrt(2 * mse / n), within[2, "Df"], family))
}

paired <- function(name, m) {
    say_pairs(name, "paired", ncol(m), function(i, j, family) {
        one <- t.test(m[, i], m[, j], paired = TRUE)
        all <- t.test(m[, i], m[, j], paired = TRUE, conf.level = 1 - 0.05 / family)
        c(difference = unname(one$estimate), t = unname(one$statistic), df = unname(one$parameter),
          p = one$p.value, low = one$conf.int[1], high = one$conf.int[2],
          low_all = all$conf.int[1], high_all = all$conf.int[2])
    })
}

friedman <- function(name, m) {
    test <- friedman.test(m)
    say(name, "friedman", c(test$statistic, test$parameter, test$p.value))
}

oneway <- function(name, groups) {
    d <- stack(groups)
    table <- anova(lm(values ~ ind, data = d))
    say(name, "anova", c(table[1, "F value"], table[1:2, "Df"], table[1, "Pr(>F)"], table[1:2, "Sum Sq"]))
    mse <- table[2, "Mean Sq"]
    say_pairs(name, "pooled", length(groups), function(i, j, family)
        pooled(mean(groups[[i]]) - mean(groups[[j]]),
               sqrt(mse * (1 / length(groups[[i]]) + 1 / length(groups[[j]]))), table[2, "Df"], family))
}

interval <- function(name, x) {
    say(name, "interval_95", t.test(x)$conf.int)
    say(name, "interval_90", t.test(x, conf.level = 0.9)$conf.int)
}

# Hodges and Lehmann's estimate, P, and the interval of this comparison alone and of six.
shift <- function(name, ...) {
    one <- wilcox.test(..., exact = TRUE, conf.int = TRUE)
    all <- wilcox.test(..., exact = TRUE, conf.int = TRUE, conf.level = 1 - 0.05 / 6)
    say(name, "shift", c(one$estimate, one$p.value, one$conf.int, all$conf.int))
}

cat("r version", paste(R.version$major, R.version$minor, sep = "."), "\n")
for (line in readLines(file("stdin"))) {
    words <- strsplit(line, " ")[[1]]
    kind <- words[1]
    name <- words[2]
    columns <- as.integer(strsplit(words[3], ",")[[1]])
    x <- as.numeric(words[-(1:3)])
    if (kind == "table") {
        m <- matrix(x, ncol = columns, byrow = TRUE)
        repeated(name, m)
        friedman(name, m)
    } else if (kind == "paired") {
        paired(name, matrix(x, ncol = columns, byrow = TRUE))
    } else if (kind == "groups") {
        groups <- split(x, rep(seq_along(columns), columns))
        oneway(name, groups)
    } else if (kind == "interval") {
        interval(name, x)
    } else if (kind == "signed_rank") {
        shift(name, x)
    } else if (kind == "rank_sum") {
        groups <- split(x, rep(seq_along(columns), columns))
        shift(name, groups[[1]], groups[[2]])
    } else if (kind == "adjust") {
        say(name, "bonferroni", p.adjust(x, "bonferroni"))
        say(name, "holm", p.adjust(x, "holm"))
    }
}
