; Make sandwiches in the kitchen, some without gluten, and serve them from trays.
;@ skill make 0 make ?s ?b ?f
;@ skill make-free 0 make-free ?s ?b ?f
;@ skill put-on-tray 0 put-on-tray ?s ?t
;@ skill serve 0 serve ?s ?c
;@ skill serve-free 0 serve-free ?s ?c
;@ skill move-tray 0 move-tray ?t ?to
(define (domain childsnack)
 (:requirements :strips :typing)
 (:types child bread filling sandwich tray place)
 (:predicates (bread-left ?b - bread) (filling-left ?f - filling) (free-bread ?b - bread) (free-filling ?f - filling)
  (fresh ?s - sandwich) (in-kitchen ?s - sandwich) (gluten-free ?s - sandwich) (on-tray ?s - sandwich ?t - tray)
  (kitchen ?p - place) (tray-at ?t - tray ?p - place) (waiting ?c - child ?p - place) (allergic ?c - child)
  (hardy ?c - child) (served ?c - child))
 (:action make
  :parameters (?s - sandwich ?b - bread ?f - filling)
  :precondition (and (bread-left ?b) (filling-left ?f) (fresh ?s))
  :effect (and (in-kitchen ?s) (not (bread-left ?b)) (not (filling-left ?f)) (not (fresh ?s))))
 (:action make-free
  :parameters (?s - sandwich ?b - bread ?f - filling)
  :precondition (and (bread-left ?b) (filling-left ?f) (free-bread ?b) (free-filling ?f) (fresh ?s))
  :effect (and (in-kitchen ?s) (gluten-free ?s) (not (bread-left ?b)) (not (filling-left ?f)) (not (fresh ?s))))
 (:action put-on-tray
  :parameters (?s - sandwich ?t - tray ?p - place)
  :precondition (and (in-kitchen ?s) (tray-at ?t ?p) (kitchen ?p))
  :effect (and (on-tray ?s ?t) (not (in-kitchen ?s))))
 (:action serve
  :parameters (?s - sandwich ?c - child ?t - tray ?p - place)
  :precondition (and (on-tray ?s ?t) (tray-at ?t ?p) (waiting ?c ?p) (hardy ?c))
  :effect (and (served ?c) (not (on-tray ?s ?t)) (not (waiting ?c ?p))))
 (:action serve-free
  :parameters (?s - sandwich ?c - child ?t - tray ?p - place)
  :precondition (and (on-tray ?s ?t) (tray-at ?t ?p) (waiting ?c ?p) (allergic ?c) (gluten-free ?s))
  :effect (and (served ?c) (not (on-tray ?s ?t)) (not (waiting ?c ?p))))
 (:action move-tray
  :parameters (?t - tray ?from ?to - place)
  :precondition (and (tray-at ?t ?from))
  :effect (and (tray-at ?t ?to) (not (tray-at ?t ?from)))))
