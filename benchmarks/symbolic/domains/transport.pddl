; Vehicles of limited capacity deliver packages over a road map.
;@ skill drive 0 drive ?v ?to
;@ skill pick-up 0 pick-up ?v ?p
;@ skill drop 0 drop ?v ?p
(define (domain transport)
 (:requirements :strips :typing)
 (:types place size movable - object vehicle package - movable)
 (:predicates (road ?a ?b - place) (at ?x - movable ?l - place) (in ?p - package ?v - vehicle)
  (capacity ?v - vehicle ?s - size) (one-less ?less ?more - size))
 (:action drive
  :parameters (?v - vehicle ?from ?to - place)
  :precondition (and (at ?v ?from) (road ?from ?to))
  :effect (and (at ?v ?to) (not (at ?v ?from))))
 (:action pick-up
  :parameters (?v - vehicle ?l - place ?p - package ?less ?more - size)
  :precondition (and (at ?v ?l) (at ?p ?l) (one-less ?less ?more) (capacity ?v ?more))
  :effect (and (in ?p ?v) (capacity ?v ?less) (not (at ?p ?l)) (not (capacity ?v ?more))))
 (:action drop
  :parameters (?v - vehicle ?l - place ?p - package ?less ?more - size)
  :precondition (and (at ?v ?l) (in ?p ?v) (one-less ?less ?more) (capacity ?v ?less))
  :effect (and (at ?p ?l) (capacity ?v ?more) (not (in ?p ?v)) (not (capacity ?v ?less)))))
